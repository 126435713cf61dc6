#include "merge/pose_ring.hpp"

#include <algorithm>

namespace concord {

Result<void> PoseRing::add(std::int64_t utime, const Transform& T_agent_base) {
  if (utime < 0 || utime > kLatest) {
    return refuse(Code::kBadRequest, "utime is no time; it must be microseconds since 1970");
  }
  if (!poses_.empty() && utime <= poses_.back().utime) poses_.clear();
  // The newest is always kept: it replaces one that came just before.
  if (poses_.size() >= 2 && utime - poses_[poses_.size() - 2].utime < kLeastStep) poses_.pop_back();
  poses_.push_back({utime, T_agent_base});
  while (poses_.front().utime < utime - kSpan) poses_.pop_front();
  return {};
}

Result<Transform> PoseRing::at(std::int64_t utime) const {
  if (poses_.empty() || utime < poses_.front().utime - kTolerance || utime > poses_.back().utime + kTolerance) {
    return refuse(Code::kStale, "no pose of the robot at that time among those of the last 30 s; is its clock right?");
  }
  const auto after = std::ranges::lower_bound(poses_, utime, {}, &Stamped::utime);
  if (after == poses_.end()) return poses_.back().T_agent_base;
  if (after == poses_.begin() || after->utime == utime) return after->T_agent_base;
  const Stamped& before = *(after - 1);
  const double share = static_cast<double>(utime - before.utime) / static_cast<double>(after->utime - before.utime);
  const Eigen::Quaterniond from(before.T_agent_base.linear());
  Transform T = Transform::Identity();
  T.linear() = from.slerp(share, Eigen::Quaterniond(after->T_agent_base.linear())).normalized().toRotationMatrix();
  T.translation() = before.T_agent_base.translation() +
                    share * (after->T_agent_base.translation() - before.T_agent_base.translation());
  return T;
}

}  // namespace concord
