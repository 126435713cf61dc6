// Requests about saved maps.

#include <cstdio>
#include <memory>

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

/// Formats are saved one after the other; the first that is refused ends it.
struct SaveRun {
  SaveRequest request;
  SaveAnswer answer;
};

void run_save(Desk& desk, const Ask& ask, const std::shared_ptr<SaveRun>& run) {
  const std::size_t step = run->answer.files.size();
  if (step == run->request.formats.size()) return desk.hub.answer(ask, run->answer);
  const std::string format = text_of(run->request.formats[step]);
  const MapRequest save{desk.id(ask) + "-" + format,
                        MapRequest::Op::kSave,
                        run->request.map,
                        format,
                        run->request.overwrite,
                        "",
                        desk.now()};
  Asker::Question question{"in/map_request", encode(save, desk.now()), save.id, {}, {}, kSavePatience};
  desk.asker.ask(std::move(question), [&desk, ask, run, format](const Answer& answer) {
    if (!answer.ok) return desk.hub.refuse(ask, code_of(answer.code), answer.message);
    run->answer.files.push_back({run->request.map + "." + format, answer.count});
    run_save(desk, ask, run);
  });
}

/// Asks merge which files there are, and goes on with what it says.
void list_maps(Desk& desk, const Ask& ask, const std::string& id, std::function<void(const MapList&)> then) {
  const MapRequest list{id, MapRequest::Op::kList, "", "", false, "", desk.now()};
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
  const MapRequest load{desk.id(ask), MapRequest::Op::kLoad,      request.map, format,
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
  const auto run = std::make_shared<SaveRun>(SaveRun{request, {}});
  char hash[17];
  std::snprintf(hash, sizeof(hash), "%016llx", static_cast<unsigned long long>(digest(desk.world.map().map())));
  run->answer.content = hash;
  run_save(desk, ask, run);
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
