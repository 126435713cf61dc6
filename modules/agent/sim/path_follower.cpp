#include "agent/sim/path_follower.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace concord {

void PathFollower::stop() {
  if (has_way()) ++stops_;
  points_.clear();
  sums_.clear();
  along_ = length_ = 0;
  path_id_ = 0;
}

void PathFollower::hear(const Path& path, std::int64_t now) {
  if (!path.frame_agent.empty()) return;
  if (!path.active) {
    // The last word on the path that it is on; else an answer to a question.
    if (path.id == request_) stop();
    return;
  }
  request_ = path.id;
  heard_ = now;
  if (path.status != "OK" || path.points.empty()) return stop();
  if (path.path_id == path_id_) return;
  points_.clear();
  sums_ = {0};
  for (const Eigen::Vector3d& p : path.points) points_.emplace_back(p.head<2>());
  for (std::size_t i = 1; i < points_.size(); ++i) {
    sums_.push_back(sums_.back() + (points_[i] - points_[i - 1]).norm());
  }
  path_id_ = path.path_id;
  length_ = sums_.back();
  // On from where it is.
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector2d way = points_[std::min(i + 1, points_.size() - 1)] - points_[i];
    const double share =
        way.squaredNorm() > 0 ? std::clamp((place_.p - points_[i]).dot(way) / way.squaredNorm(), 0.0, 1.0) : 0.0;
    const double away = (points_[i] + share * way - place_.p).norm();
    if (away >= least) continue;
    least = away;
    along_ = sums_[i] + share * way.norm();
  }
  if (least > kBeside) stop();
}

PathFollower::Place PathFollower::at(double along) const {
  const auto next = std::upper_bound(sums_.begin(), sums_.end(), along);
  const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(next - sums_.begin(), 1, std::ssize(sums_) - 1));
  const Eigen::Vector2d way = points_[i] - points_[i - 1];
  const double length = sums_[i] - sums_[i - 1];
  const double share = length > 0 ? std::min((along - sums_[i - 1]) / length, 1.0) : 1.0;
  return {points_[i - 1] + share * way, std::atan2(way.y(), way.x())};
}

double PathFollower::heading() const { return has_way() ? at(along_).yaw : place_.yaw; }

bool PathFollower::go(double seconds, double free, std::int64_t now) {
  if (!has_way()) return false;
  if (now - heard_ > kPatience) {
    stop();
    return false;
  }
  const double step = std::min({speed_ * seconds, length_ - along_, std::max(free, 0.0)});
  if (step <= 0) return false;
  along_ += step;
  driven_ += step;
  place_ = at(along_);
  return true;
}

}  // namespace concord
