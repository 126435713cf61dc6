// Requests that change the map as people do: edits, zones, leases, scenes.

#include <algorithm>
#include <memory>
#include <tuple>

#include "bridge/requests.hpp"
#include "core/text.hpp"

namespace concord::hmd {
namespace {

Code zone_code(const std::string& code) { return code == "MALFORMED" ? Code::kBadName : code_of(code); }

/// An edit as merge takes it, or why it cannot be.
Granted<concord::EditRequest> edit_of(Desk& desk, const Ask& ask, const EditRequest& request) {
  const auto where = desk.place(ask, request.frame);
  if (!where) return tl::unexpected(where.error());
  auto shape = from_hmd(request.shape);
  if (!shape) return no(shape.error());
  if ((request.op == EditOp::kMove) != request.move.has_value())
    return no(Code::kBadRequest, request.move ? "move goes with op move alone" : "op move takes move, how far");
  concord::EditRequest edit;
  edit.id = desk.id(ask);
  edit.author = desk.author(ask);
  edit.op = request.op == EditOp::kAdd      ? concord::EditRequest::Op::kAdd
            : request.op == EditOp::kDelete ? concord::EditRequest::Op::kDelete
                                            : concord::EditRequest::Op::kMove;
  edit.shape = std::move(*shape);
  edit.frame = where->frame;
  if (request.move) edit.move = vector_of(*request.move);
  edit.base_revision = request.base_revision.value_or(kAnyRevision);
  edit.utime = desk.now();
  return edit;
}

/// Four times as much as elsewhere.
constexpr int kCostOfCostly = 3;

Granted<concord::ZoneRequest> zone_of(Desk& desk, const Ask& ask, const std::string& name, ZoneKind kind, Frame frame,
                                      const Volume& volume) {
  const auto where = desk.place(ask, frame);
  if (!where) return tl::unexpected(where.error());
  auto drawn = from_hmd(volume);
  if (!drawn) return no(drawn.error());
  if (!is_title(name)) return no(Code::kBadName, "a zone's name is 1 to 80 bytes of printable text without slashes");
  concord::ZoneRequest zone;
  zone.id = desk.id(ask);
  zone.author = desk.author(ask);
  zone.name = name;
  zone.kind = from_hmd(kind);
  if (zone.kind == concord::Zone::Kind::kCostly) zone.cost = kCostOfCostly;
  // What headsets cannot say stays as it was.
  for (const concord::Zone& known : desk.world.zones()) {
    if (known.name == name && known.kind == zone.kind)
      std::tie(zone.margin, zone.cost) = std::tie(known.margin, known.cost);
  }
  zone.volume = std::move(*drawn);
  zone.frame = where->frame;
  zone.utime = desk.now();
  return zone;
}

void undo_or_redo(Desk& desk, const Ask& ask, const std::string& edit, bool redo) {
  if (edit.starts_with(kLabelUndo)) return undo_label(desk, ask, edit.substr(kLabelUndo.size()), redo);
  if (!is_request_id(edit)) return desk.hub.refuse(ask, Code::kNotFound, "no edit has this id");
  const concord::UndoRequest undo{desk.id(ask), desk.author(ask), edit, redo, desk.now()};
  if (redo) {
    desk.forward(ask, "in/undo", encode(undo), [](const Answer& a) { return RedoAnswer{a.revision, a.count}; });
  } else {
    desk.forward(ask, "in/undo", encode(undo), [](const Answer& a) { return UndoAnswer{a.revision, a.count}; });
  }
}

}  // namespace

void work_on(Desk& desk, const Ask& ask, const EditRequest& request) {
  const auto edit = edit_of(desk, ask, request);
  if (!edit) return desk.refuse(ask, edit.error());
  desk.forward(ask, "in/edit", encode(*edit), [id = edit->id](const Answer& a) {
    return EditAnswer{id, a.revision, a.count};
  });
}

void work_on(Desk& desk, const Ask& ask, const UndoRequest& request) { undo_or_redo(desk, ask, request.edit, false); }
void work_on(Desk& desk, const Ask& ask, const RedoRequest& request) { undo_or_redo(desk, ask, request.edit, true); }

void work_on(Desk& desk, const Ask& ask, const ZoneAddRequest& request) {
  const auto zone = zone_of(desk, ask, request.name, request.zone_kind, request.frame, request.volume);
  if (!zone) return desk.refuse(ask, zone.error());
  desk.forward(
      ask, "in/zone", encode(*zone), [](const Answer& a) { return ZoneAddAnswer{a.revision}; }, zone_code);
}

void work_on(Desk& desk, const Ask& ask, const ZoneChangeRequest& request) {
  auto zone = zone_of(desk, ask, request.name, request.zone_kind, request.frame, request.volume);
  if (!zone) return desk.refuse(ask, zone.error());
  zone->op = concord::ZoneRequest::Op::kChange;
  zone->base_revision = request.base_revision.value_or(kAnyRevision);
  desk.forward(
      ask, "in/zone", encode(*zone), [](const Answer& a) { return ZoneChangeAnswer{a.revision}; }, zone_code);
}

void work_on(Desk& desk, const Ask& ask, const ZoneDeleteRequest& request) {
  if (!is_title(request.name)) return desk.hub.refuse(ask, Code::kBadName, "no zone can be called so");
  concord::ZoneRequest zone;
  zone.id = desk.id(ask);
  zone.author = desk.author(ask);
  zone.op = concord::ZoneRequest::Op::kDelete;
  zone.name = request.name;
  zone.volume = concord::Box{};
  zone.base_revision = request.base_revision.value_or(kAnyRevision);
  zone.utime = desk.now();
  desk.forward(
      ask, "in/zone", encode(zone), [](const Answer& a) { return ZoneDeleteAnswer{a.revision}; }, zone_code);
}

void work_on(Desk& desk, const Ask& ask, const LeaseHoldRequest& request) {
  const auto where = desk.place(ask, request.frame);
  if (!where) return desk.refuse(ask, where.error());
  auto volume = from_hmd(request.volume);
  if (!volume) return desk.refuse(ask, {code_of(volume.error()), volume.error().message});
  const concord::LeaseRequest lease{desk.id(ask), desk.author(ask),   desk.lease_id(ask, request.lease),
                                    true,         std::move(*volume), where->frame,
                                    desk.now()};
  desk.forward(ask, "in/lease", encode(lease), [](const Answer&) { return LeaseHoldAnswer{}; });
}

void work_on(Desk& desk, const Ask& ask, const LeaseFreeRequest& request) {
  const concord::LeaseRequest lease{
      desk.id(ask), desk.author(ask), desk.lease_id(ask, request.lease), false, concord::Box{}, {}, desk.now()};
  desk.forward(ask, "in/lease", encode(lease), [](const Answer&) { return LeaseFreeAnswer{}; });
}

namespace {

/// A merge that is started anew answers within it.
constexpr std::int64_t kScenePatience = 30'000'000;

/// A scene on its way: its steps are done one after the other.
struct SceneRun {
  std::vector<concord::EditRequest> edits;
  std::vector<concord::ZoneRequest> zones;
  std::vector<std::string> known;  ///< what this scene itself has done is no change by others
  std::size_t next = 0;
  SceneSendAnswer answer;
};

void run_scene(Desk& desk, const Ask& ask, const std::shared_ptr<SceneRun>& run) {
  if (run->next == run->edits.size() + run->zones.size()) return desk.hub.answer(ask, run->answer);
  const std::size_t step = run->next++;
  const bool is_edit = step < run->edits.size();
  if (is_edit) run->edits[step].known = run->known;
  const concord::ZoneRequest* zone = is_edit ? nullptr : &run->zones[step - run->edits.size()];
  const std::string id = is_edit ? run->edits[step].id : zone->id;
  Asker::Question question{
      is_edit ? "in/edit" : "in/zone", is_edit ? encode(run->edits[step]) : encode(*zone), id, {}, {}, kScenePatience};
  desk.asker.ask(std::move(question), [&desk, ask, run, is_edit, id](const Answer& answer) {
    if (!answer.ok) {
      const Code code = zone_code(answer.code);
      const bool may_be_done = code == Code::kTimeout && is_edit;
      if (run->next == 1 && !may_be_done) return desk.hub.refuse(ask, code, answer.message);
      if (may_be_done) run->answer.unsure = id;
      run->answer.stopped = Refusal{code, cut_to(answer.message, 400), may_retry(code)};
      return desk.hub.answer(ask, run->answer);
    }
    run->answer.revision = answer.revision;
    if (is_edit) {
      run->answer.edits.push_back(id);
      run->known.push_back(id);
    } else {
      ++run->answer.zones;
    }
    run_scene(desk, ask, run);
  });
}

}  // namespace

void work_on(Desk& desk, const Ask& ask, const SceneSendRequest& request) {
  const auto run = std::make_shared<SceneRun>();
  run->answer.revision = request.base_revision;
  run->known = request.known.value_or(std::vector<std::string>());
  if (!std::ranges::all_of(run->known, is_request_id))
    return desk.hub.refuse(ask, Code::kBadRequest, "known must hold ids of edits");
  if (request.edits.empty() && request.zones.empty()) return desk.hub.refuse(ask, Code::kEmpty, "nothing to do");
  for (const SceneEdit& part : request.edits) {
    if (part.op == EditOp::kMove)
      return desk.hub.refuse(ask, Code::kBadRequest, "a scene adds and deletes; move with edit");
    auto edit = edit_of(desk, ask, {part.op, request.frame, part.shape, {}, request.base_revision});
    if (!edit) return desk.refuse(ask, edit.error());
    edit->id += "-e" + std::to_string(run->edits.size());
    run->edits.push_back(std::move(*edit));
  }
  for (const SceneZone& part : request.zones) {
    auto zone = zone_of(desk, ask, part.name, part.zone_kind, request.frame, part.volume);
    if (!zone) return desk.refuse(ask, zone.error());
    const auto& known = desk.world.zones();
    const bool there =
        std::any_of(known.begin(), known.end(), [&](const concord::Zone& z) { return z.name == part.name; });
    zone->id += "-z" + std::to_string(run->zones.size());
    if (there) {
      zone->op = concord::ZoneRequest::Op::kChange;
      zone->base_revision = request.base_revision;
    }
    run->zones.push_back(std::move(*zone));
  }
  run_scene(desk, ask, run);
}

}  // namespace concord::hmd
