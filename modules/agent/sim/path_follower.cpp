#include "agent/sim/path_follower.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace concord {

void PathFollower::stop() {
  if (has_way()) ++stops_;
  points_.clear();
  yaws_.clear();
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
  std::vector<Eigen::Vector2d> points;
  std::vector<double> sums{0};
  for (const Eigen::Vector3d& p : path.points) points.emplace_back(p.head<2>());
  for (std::size_t i = 1; i < points.size(); ++i) sums.push_back(sums.back() + (points[i] - points[i - 1]).norm());
  // On from where it is.
  double least = std::numeric_limits<double>::infinity(), along = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d way = points[std::min(i + 1, points.size() - 1)] - points[i];
    const double share =
        way.squaredNorm() > 0 ? std::clamp((place_.p - points[i]).dot(way) / way.squaredNorm(), 0.0, 1.0) : 0.0;
    const double away = (points[i] + share * way - place_.p).norm();
    if (away >= least) continue;
    least = away;
    along = sums[i] + share * way.norm();
  }
  if (least > kBeside) return stop();
  path_id_ = path.path_id;
  points_ = std::move(points);
  sums_ = std::move(sums);
  along_ = along;
  length_ = sums_.back();
  yaws_.clear();
  if (path.footprint.empty() || path.details.size() != points_.size()) return;
  for (const PathPoint& detail : path.details) yaws_.push_back(detail.yaw);
}

PathFollower::Step PathFollower::at(double along) const {
  const auto next = std::upper_bound(sums_.begin(), sums_.end(), along);
  const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(next - sums_.begin(), 1, std::ssize(sums_) - 1));
  const Eigen::Vector2d way = points_[i] - points_[i - 1];
  const double length = sums_[i] - sums_[i - 1];
  const double share = length > 0 ? std::min((along - sums_[i - 1]) / length, 1.0) : 1.0;
  const double heading = std::atan2(way.y(), way.x());
  const auto wrapped = [](double angle) { return std::remainder(angle, 2 * M_PI); };
  const double yaw = yaws_.empty() ? heading : wrapped(yaws_[i - 1] + share * wrapped(yaws_[i] - yaws_[i - 1]));
  return {{points_[i - 1] + share * way, yaw}, heading};
}

double PathFollower::heading() const { return has_way() ? at(along_).heading : place_.yaw; }

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
  place_ = at(along_).place;
  return true;
}

}  // namespace concord
