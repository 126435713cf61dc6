// Requests about labels: classes, instances, what people call things.

#include <algorithm>
#include <map>

#include "bridge/ask_semantic.hpp"
#include "bridge/requests.hpp"
#include "core/touch.hpp"

namespace concord::hmd {
namespace {

using Op = concord::LabelRequest::Op;

std::string undo_of(const std::string& correction) { return std::string(kLabelUndo) + correction; }

concord::LabelRequest label_request(Desk& desk, const Ask& ask, Op op) {
  concord::LabelRequest request;
  request.id = desk.id(ask);
  request.author = desk.author(ask);
  request.op = op;
  request.utime = desk.now();
  return request;
}

/// Semantic says of classes and of instances alike that they are not there.
Translation missing(Desk& desk, ClassId label) {
  return [&desk, label](const std::string& code) {
    if (code != "NOT_FOUND") return code == "MALFORMED" ? Code::kBadName : code_of(code);
    return desk.world.things().classes().contains(label) ? Code::kNoInstance : Code::kNoLabel;
  };
}

Code naming_code(const std::string& code) { return code == "MALFORMED" ? Code::kBadName : code_of(code); }

/// Numbers from outside; those that no class or instance can have are none's.
std::uint32_t number_of(std::int64_t number) {
  return number <= INT32_MAX ? static_cast<std::uint32_t>(number) : INT32_MAX;
}

bool check_name(Desk& desk, const Ask& ask, const std::string& name) {
  if (is_title(name)) return true;
  desk.hub.refuse(ask, Code::kBadName, "a class's name is 1 to 80 bytes of printable text without slashes");
  return false;
}

/// Labels what a shape selects or what is touched there; answers with `good`.
template <class Good>
void label(Desk& desk, const Ask& ask, concord::LabelRequest request, Good good) {
  ask_semantic(
      desk, ask, request.id, "in/label", encode(request), true,
      [&desk, ask, undo = undo_of(request.id), good](const Answer& answer, const std::vector<LabelInstance>& made) {
        desk.hub.answer(ask, good(answer, made.empty() ? LabelInstance{} : made.front(), undo));
      },
      naming_code);
}

/// Takes off a label, or deletes what shows it: an instance's, or (instance 0) a class's.
template <class DeleteAnswer>
void take_away(Desk& desk, const Ask& ask, InstanceId of, bool keep_voxels) {
  ask_instances(desk, ask, of.label, [&desk, ask, of, keep_voxels](const std::vector<LabelInstance>& all) {
    std::int64_t voxels = 0;
    bool is_there = of.instance == 0;
    for (const LabelInstance& one : all) {
      if (of.instance != 0 && one.of != of) continue;
      is_there = true;
      voxels += one.voxels;
    }
    if (!is_there) return desk.hub.refuse(ask, Code::kNoInstance, "nothing of this number shows in the map");
    concord::LabelRequest request = label_request(desk, ask, keep_voxels ? Op::kTakeOff : Op::kDelete);
    request.of = of;
    const std::string undo = keep_voxels ? undo_of(request.id) : request.id;
    // Deleting is an edit, which merge answers.
    ask_semantic(
        desk, ask, request.id, "in/label", encode(request), false,
        [&desk, ask, voxels, undo](const Answer&, const std::vector<LabelInstance>&) {
          desk.hub.answer(ask, DeleteAnswer{voxels, undo});
        },
        missing(desk, of.label));
  });
}

}  // namespace

void work_on(Desk& desk, const Ask& ask, const LabelsRequest& /*request*/) {
  ask_instances(desk, ask, {}, [&desk, ask](const std::vector<LabelInstance>& all) {
    std::map<ClassId, Label> classes;
    for (const auto& [number, name] : desk.world.things().classes()) classes[number] = {number, name, 0, 0};
    for (const LabelInstance& one : all) {
      Label& there = classes.try_emplace(one.of.label, Label{one.of.label, one.name, 0, 0}).first->second;
      ++there.instances;
      there.voxels += one.voxels;
    }
    LabelsAnswer answer;
    answer.in_all = static_cast<std::int64_t>(classes.size());
    for (auto& [number, one] : classes) {
      if (answer.labels.size() < 1000) answer.labels.push_back(std::move(one));
    }
    desk.hub.answer(ask, answer);
  });
}

void work_on(Desk& desk, const Ask& ask, const InstancesRequest& request) {
  if (request.most < 1 || request.most > 1000) return desk.hub.refuse(ask, Code::kBadRequest, "most is 1 to 1000");
  const auto number = request.label ? std::optional<ClassId>(number_of(*request.label)) : std::nullopt;
  ask_instances(desk, ask, number, [&desk, ask, most = request.most](const std::vector<LabelInstance>& all) {
    InstancesAnswer answer;
    answer.in_all = static_cast<std::int64_t>(all.size());
    for (const LabelInstance& one : all) {
      if (answer.instances.size() >= static_cast<std::size_t>(most)) break;
      const auto [min, max] = corners_of(one, desk.context.site.resolution);
      Instance instance{one.of.label, one.of.instance, one.name, one.voxels, min, max, {}, {}};
      if (!one.asset.empty()) {
        instance.asset = one.asset;
        instance.T_map_asset = to_hmd(one.T_map_asset);
      }
      answer.instances.push_back(std::move(instance));
    }
    desk.hub.answer(ask, answer);
  });
}

void work_on(Desk& desk, const Ask& ask, const LabelRequest& request) {
  const auto where = desk.place(ask, request.frame);
  if (!where) return desk.refuse(ask, where.error());
  auto shape = from_hmd(request.shape);
  if (!shape) return desk.refuse(ask, {code_of(shape.error()), shape.error().message});
  if (!check_name(desk, ask, request.class_name)) return;
  concord::LabelRequest asked = label_request(desk, ask, Op::kLabel);
  asked.name = request.class_name;
  asked.shape = std::move(*shape);
  asked.frame = where->frame;
  label(desk, ask, std::move(asked), [](const Answer& answer, const LabelInstance& made, const std::string& undo) {
    return LabelAnswer{made.of.label, made.of.instance, answer.count, undo};
  });
}

void work_on(Desk& desk, const Ask& ask, const LabelTouchRequest& request) {
  const auto where = desk.place(ask, request.frame);
  if (!where) return desk.refuse(ask, where.error());
  if (!check_name(desk, ask, request.class_name)) return;
  concord::LabelRequest asked = label_request(desk, ask, Op::kTouch);
  asked.name = request.class_name;
  asked.shape = touch_at(vector_of(request.p));
  asked.frame = where->frame;
  const double resolution = desk.context.site.resolution;
  label(desk, ask, std::move(asked),
        [resolution](const Answer& answer, const LabelInstance& made, const std::string& undo) {
          const auto [min, max] = corners_of(made, resolution);
          return LabelTouchAnswer{made.of.label, made.of.instance, answer.count, min, max, undo};
        });
}

void work_on(Desk& desk, const Ask& ask, const LabelRenameRequest& request) {
  if (!check_name(desk, ask, request.name)) return;
  concord::LabelRequest asked = label_request(desk, ask, Op::kRename);
  asked.of.label = number_of(request.label);
  asked.name = request.name;
  ask_semantic(
      desk, ask, asked.id, "in/label", encode(asked), false,
      [&desk, ask, undo = undo_of(asked.id)](const Answer&, const std::vector<LabelInstance>&) {
        desk.hub.answer(ask, LabelRenameAnswer{undo});
      },
      [](const std::string& code) { return code == "NOT_FOUND" ? Code::kNoLabel : naming_code(code); });
}

void work_on(Desk& desk, const Ask& ask, const InstanceReassignRequest& request) {
  if (!check_name(desk, ask, request.class_name)) return;
  concord::LabelRequest asked = label_request(desk, ask, Op::kReassign);
  asked.of = {number_of(request.label), number_of(request.instance)};
  asked.name = request.class_name;
  if (asked.of.instance == 0) return desk.hub.refuse(ask, Code::kNoInstance, "instances count from 1");
  ask_semantic(
      desk, ask, asked.id, "in/label", encode(asked), true,
      [&desk, ask, undo = undo_of(asked.id)](const Answer&, const std::vector<LabelInstance>& made) {
        const LabelInstance now = made.empty() ? LabelInstance{} : made.front();
        desk.hub.answer(ask, InstanceReassignAnswer{now.of.label, now.of.instance, now.voxels, undo});
      },
      missing(desk, asked.of.label));
}

void work_on(Desk& desk, const Ask& ask, const InstanceDeleteRequest& request) {
  const InstanceId of{number_of(request.label), number_of(request.instance)};
  if (of.instance == 0) return desk.hub.refuse(ask, Code::kNoInstance, "instances count from 1");
  take_away<InstanceDeleteAnswer>(desk, ask, of, request.keep_voxels);
}

void work_on(Desk& desk, const Ask& ask, const LabelDeleteRequest& request) {
  take_away<LabelDeleteAnswer>(desk, ask, {number_of(request.label), 0}, request.keep_voxels);
}

void undo_label(Desk& desk, const Ask& ask, const std::string& correction, bool redo) {
  if (!is_request_id(correction)) return desk.hub.refuse(ask, Code::kNotFound, "nothing has this id");
  concord::LabelRequest asked = label_request(desk, ask, redo ? Op::kRedo : Op::kUndo);
  asked.correction_id = correction;
  ask_semantic(desk, ask, asked.id, "in/label", encode(asked), false,
               [&desk, ask, redo](const Answer& answer, const std::vector<LabelInstance>&) {
                 if (redo) return desk.hub.answer(ask, RedoAnswer{answer.revision, answer.count});
                 desk.hub.answer(ask, UndoAnswer{answer.revision, answer.count});
               });
}

}  // namespace concord::hmd
