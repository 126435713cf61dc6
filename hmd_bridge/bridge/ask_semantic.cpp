#include "bridge/ask_semantic.hpp"

#include <utility>

namespace concord::hmd {
namespace {

constexpr std::int64_t kModelPatience = 90'000'000;  ///< microseconds: a model is read for a minute at most

/// What was told for a request; its parts are kept no longer.
std::vector<LabelInstance> take_list(Desk& desk, const std::string& id) {
  std::vector<LabelInstance> all;
  const auto node = desk.labels.extract(id);
  if (node.empty()) return all;
  for (const auto& [number, part] : node.mapped()) {
    all.insert(all.end(), part.instances.begin(), part.instances.end());
  }
  return all;
}

}  // namespace

void ask_semantic(Desk& desk, const Ask& ask, const std::string& id, const std::string& channel, Bytes message,
                  bool with_list, std::function<void(const Answer&, const std::vector<LabelInstance>&)> then,
                  Translation translate) {
  if (!desk.world.alive("semantic")) return desk.hub.refuse(ask, Code::kUnavailable, "no process of this stack labels");
  Asker::Question question{channel, std::move(message), id, {}, {}};
  // These read a model; asked again meanwhile, they are not done twice.
  if (channel == "in/asset" || channel == "in/detection_decision") question.patience = kModelPatience;
  if (with_list) {
    desk.labels[id];
    question.whole = [&desk, id] { return all_there(desk.labels, id); };
  }
  desk.asker.ask(std::move(question), [&desk, ask, id, then, translate](const Answer& answer) {
    const auto list = take_list(desk, id);
    if (!answer.ok) {
      return desk.hub.refuse(ask, translate ? translate(answer.code) : code_of(answer.code), answer.message);
    }
    if (desk.hub.find(ask.session) != nullptr) then(answer, list);
  });
}

void ask_instances(Desk& desk, const Ask& ask, std::optional<ClassId> label,
                   std::function<void(const std::vector<LabelInstance>&)> then) {
  LabelQuery query;
  query.id = desk.id(ask) + "-list";
  const auto& classes = desk.world.things().classes();
  const auto known = label ? classes.find(*label) : classes.end();
  if (known != classes.end()) {
    query.kind = LabelQuery::Kind::kClass;
    query.name = known->second;
  }
  const bool is_known = known != classes.end();
  const auto filter = [&desk, ask, label, then, is_known](const Answer&, std::vector<LabelInstance> all) {
    if (label) std::erase_if(all, [&](const LabelInstance& one) { return one.of.label != *label; });
    if (label && !is_known && all.empty()) return desk.hub.refuse(ask, Code::kNoLabel, "no class has this number");
    then(all);
  };
  ask_semantic(desk, ask, query.id, "in/label_query", encode(query, desk.now()), true, filter,
               [](const std::string& code) { return code == "NOT_FOUND" ? Code::kNoLabel : code_of(code); });
}

Corners corners_of(const LabelInstance& instance, double resolution) {
  const auto corner = [resolution](VoxelIndex v, int more) {
    return array_of(resolution * Eigen::Vector3d(v.x + more, v.y + more, v.z + more));
  };
  if (instance.voxels == 0) return {corner({}, 0), corner({}, 0)};
  return {corner(instance.min, 0), corner(instance.max, 1)};
}

}  // namespace concord::hmd
