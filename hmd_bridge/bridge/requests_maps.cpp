// Requests about saved maps.

#include <cstdio>

#include "bridge/requests.hpp"
#include "core/text.hpp"

namespace concord::hmd {
namespace {

constexpr std::int64_t kSavePatience = 60'000'000;
constexpr std::int64_t kLoadAgain = 1'000'000;

Code load_code(const std::string& code) {
  if (code == "NO_MAP" || code == "NOT_FOUND") return Code::kNotFound;
  if (code == "MALFORMED" || code == "NOT_FINITE" || code == "BAD_TRANSFORM" || code == "RES_MISMATCH")
    return Code::kCorrupt;
  return code_of(code);
}

SaveAnswer saved(const MapRequest& save, const Answer& answer) {
  SaveAnswer out;
  for (std::size_t i = 0; i < save.formats.size() && i < answer.parts.size(); ++i) {
    out.files.push_back({save.map + "." + save.formats[i], answer.parts[i]});
  }
  char hash[17];
  std::snprintf(hash, sizeof(hash), "%016llx", static_cast<unsigned long long>(answer.content));
  out.content = hash;
  return out;
}

/// Asks merge which files there are, and goes on with what it says.
void list_maps(Desk& desk, const Ask& ask, const std::string& id, std::function<void(const MapList&)> then) {
  const MapRequest list{id, MapRequest::Op::kList, "", {}, false, "", desk.now()};
  desk.maps.erase(id);
  desk.watched.insert(id);
  desk.asker.ask({"in/map_request", encode(list, desk.now()), id, [&desk, id] { return desk.maps.contains(id); }, {}},
                 [&desk, ask, id, then](const Answer& answer) {
                   desk.watched.erase(id);
                   const auto node = desk.maps.extract(id);
                   if (!answer.ok) return desk.hub.refuse(ask, code_of(answer.code), answer.message);
                   then(node.mapped());
                 });
}

void load(Desk& desk, const Ask& ask, const LoadRequest& request, const std::string& format) {
  const bool native = format == "concord";
  if (native && request.agent)
    return desk.hub.refuse(ask, Code::kBadRequest, "the agents of a concord file keep their names");
  const MapRequest load{desk.id(ask), MapRequest::Op::kLoad,      request.map, {format},
                        false,        request.agent.value_or(""), desk.now()};
  // A native map is checked by merge, taken in by ingest, corrected by merge, labelled by semantic: all are asked until
  // all have it.
  Asker::Question question{"in/map_request", encode(load, desk.now()), load.id, {}, {}, Asker::kLoadPatience,
                           kLoadAgain};
  if (native) question.processes = {"ingest", "merge"};
  if (native && desk.world.alive("semantic")) question.processes.insert("semantic");
  const std::string agent = request.agent.value_or(request.map);
  desk.asker.ask(std::move(question), [&desk, ask, agent](const Answer& answer) {
    if (!answer.ok) return desk.hub.refuse(ask, load_code(answer.code), answer.message);
    desk.hub.answer(ask, LoadAnswer{agent, answer.count});
  });
}

}  // namespace

void work_on(Desk& desk, const Ask& ask, const SaveRequest& request) {
  if (request.formats.empty()) return desk.hub.refuse(ask, Code::kBadRequest, "name at least one format");
  MapRequest save{desk.id(ask), MapRequest::Op::kSave, request.map, {}, request.overwrite, "", desk.now()};
  for (const Format format : request.formats) save.formats.push_back(text_of(format));
  Asker::Question question{"in/map_request", encode(save, desk.now()), save.id, {}, {"merge"}, kSavePatience};
  desk.asker.ask(std::move(question), [&desk, ask, save](const Answer& answer) {
    if (!answer.ok) return desk.hub.refuse(ask, code_of(answer.code), answer.message);
    desk.hub.answer(ask, saved(save, answer));
  });
}

void work_on(Desk& desk, const Ask& ask, const MapsRequest& /*request*/) {
  list_maps(desk, ask, desk.id(ask), [&desk, ask](const MapList& list) {
    MapsAnswer answer;
    for (const auto& [file, bytes] : list.files) {
      if (answer.maps.size() < 1000) answer.maps.push_back({cut_to(file, 60), bytes});
    }
    desk.hub.answer(ask, answer);
  });
}

void work_on(Desk& desk, const Ask& ask, const LoadRequest& request) {
  if (request.format) return load(desk, ask, request, text_of(*request.format));
  list_maps(desk, ask, desk.id(ask) + "-list", [&desk, ask, request](const MapList& list) {
    for (const char* format : {"concord", "ot", "bt"}) {
      for (const auto& [file, bytes] : list.files) {
        if (file == request.map + "." + format) return load(desk, ask, request, format);
      }
    }
    desk.hub.refuse(ask, Code::kNotFound, "no saved map is called " + request.map);
  });
}

}  // namespace concord::hmd
