#include "planner/blamed_edits_node.hpp"

#include <cmath>

namespace concord {

void BlamedEditsNode::ask(const std::string& robot, std::int64_t path_id, const Eigen::Vector2d& p, const Band& band) {
  if (asked_.size() >= kMaxAsked) asked_.erase(asked_.begin());
  HistoryRequest request;
  request.id = context_.process + "-" + std::to_string(context_.boot_id) + "-" + std::to_string(++count_);
  request.most = 10'000;
  const double r = context_.site.resolution;
  // The cell that the way is closed at is as far from the pinned one as the robot is wide.
  const auto at = [&](double metres) { return static_cast<std::int32_t>(std::floor(metres / r)); };
  const double reach = context_.site.agent(robot).radius + 2 * r;
  Asked& asked = asked_[request.id];
  asked.blamed = {robot, path_id, {}, {}};
  asked.low = {at(p.x() - reach), at(p.y() - reach), band.first};
  asked.high = {at(p.x() + reach), at(p.y() + reach), band.last - 1};
  context_.bus.publish("in/history_request", encode(request, context_.bus.now()));
}

std::optional<BlamedEditsNode::Blamed> BlamedEditsNode::take(const HistoryPart& part) {
  const auto it = asked_.find(part.id);
  if (it == asked_.end()) return std::nullopt;
  Asked& asked = it->second;
  if (!asked.heard.insert(part.part).second) return std::nullopt;
  for (const Operation& operation : part.operations) {
    const bool meets = operation.min.x <= asked.high.x && operation.max.x >= asked.low.x &&
                       operation.min.y <= asked.high.y && operation.max.y >= asked.low.y &&
                       operation.min.z <= asked.high.z && operation.max.z >= asked.low.z;
    if (!is_edit(operation.kind) || !operation.active || !meets || operation.revision < asked.revision) continue;
    asked.revision = operation.revision;
    asked.blamed.edit = operation.id;
    asked.blamed.author = operation.author;
  }
  if (static_cast<std::int32_t>(asked.heard.size()) < part.parts) return std::nullopt;
  Blamed blamed = std::move(asked.blamed);
  asked_.erase(it);
  return blamed.edit.empty() ? std::nullopt : std::optional(std::move(blamed));
}

}  // namespace concord
