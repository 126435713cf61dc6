#include "planner/pose_planners.hpp"

#include <algorithm>

namespace concord {

std::shared_ptr<PosePlanner> PosePlanners::at(const std::string& robot, const Body& body) {
  const auto it = std::find_if(kept_.begin(), kept_.end(),
                               [&](const Kept& kept) { return kept.robot == robot && kept.planner->body() == body; });
  if (it != kept_.end()) {
    std::rotate(it, it + 1, kept_.end());
    return kept_.back().planner;
  }
  std::int64_t cells = 0;
  for (const Kept& kept : kept_) cells += kept.planner->cells();
  while (!kept_.empty() && (kept_.size() >= kMaxKept || cells > kMaxKeptCells)) {
    cells -= kept_.front().planner->cells();
    made_ += kept_.front().planner->made();
    kept_.erase(kept_.begin());
  }
  kept_.push_back({robot, std::make_shared<PosePlanner>(terrain_, body)});
  return kept_.back().planner;
}

void PosePlanners::clear() {
  made_ = made();
  kept_.clear();
}

std::int64_t PosePlanners::made() const {
  std::int64_t sum = made_;
  for (const Kept& kept : kept_) sum += kept.planner->made();
  return sum;
}

void PosePlanners::follow(std::span<const BrickIndex> columns) {
  for (const Kept& kept : kept_) kept.planner->update(columns);
}

}  // namespace concord
