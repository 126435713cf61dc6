#include "agent/sim/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace concord {
namespace {

using std::numbers::pi;

struct Route {
  std::vector<Eigen::Vector2d> points;  // map frame
  double speed;                         // m/s
  double turn_rate;                     // rad/s
};

/// Kept clear of everything that stands in the warehouse by at least a robot's radius; the headset's goes where robots
/// cannot.
const Route& route_of(AgentKind kind) {
  static const Route kLidar{{{2.0, 2.2},
                             {7.0, 1.7},
                             {16.0, 1.7},
                             {16.2, 5.0},
                             {3.2, 5.0},
                             {3.2, 8.2},
                             {15.4, 8.2},
                             {21.5, 8.5},
                             {21.2, 13.4}},
                            1.0,
                            1.5};
  static const Route kCamera{{{22.3, 13.6},
                              {20.8, 8.6},
                              {20.6, 4.0},
                              {22.2, 2.2},
                              {19.0, 3.6},
                              {20.6, 5.0},
                              {20.6, 8.4},
                              {16.5, 8.3},
                              {16.3, 5.2},
                              {15.8, 8.2},
                              {4.0, 8.2}},
                             0.8,
                             1.2};
  static const Route kHeadset{
      {{4.4, 14.0}, {3.4, 13.8}, {4.2, 10.7}, {13.6, 10.7}, {15.7, 10.4}, {15.9, 9.0}, {16.4, 13.2}, {7.0, 13.6}},
      0.65,
      1.2};
  switch (kind) {
    case AgentKind::kLidar: return kLidar;
    case AgentKind::kCamera: return kCamera;
    case AgentKind::kHeadset: break;
  }
  return kHeadset;
}

constexpr double kLidarHeight = 0.8, kCameraHeight = 0.6, kEyeHeight = 1.6;
constexpr double kCameraPitch = 0.15;  // down

Eigen::AngleAxisd turn(double yaw) { return {yaw, Eigen::Vector3d::UnitZ()}; }
Eigen::AngleAxisd bow(double pitch) { return {pitch, Eigen::Vector3d::UnitY()}; }

Transform pose(double x, double y, double z, const Eigen::Quaterniond& rotation) {
  Transform T = Transform::Identity();
  T.linear() = rotation.toRotationMatrix();
  T.translation() = Eigen::Vector3d(x, y, z);
  return T;
}

}  // namespace

std::optional<AgentKind> agent_kind(std::string_view name) {
  if (name == "lidar") return AgentKind::kLidar;
  if (name == "camera") return AgentKind::kCamera;
  if (name == "headset") return AgentKind::kHeadset;
  return std::nullopt;
}

Transform start_pose(AgentKind kind) {
  const std::vector<Eigen::Vector2d>& points = route_of(kind).points;
  const Eigen::Vector2d way = points[1] - points[0];
  const double z = kind == AgentKind::kHeadset ? kEyeHeight : 0;
  return pose(points[0].x(), points[0].y(), z, Eigen::Quaterniond(turn(std::atan2(way.y(), way.x()))));
}

Trajectory::Trajectory(AgentKind kind) : kind_(kind) {
  const Route& route = route_of(kind);
  for (std::size_t i = 0; i + 1 < route.points.size(); ++i) {
    const Eigen::Vector2d from = route.points[i], to = route.points[i + 1], way = to - from;
    const double yaw = std::atan2(way.y(), way.x());
    if (keys_.empty()) keys_.push_back({0, from.x(), from.y(), yaw});
    const double by = std::remainder(yaw - keys_.back().yaw, 2 * pi);
    const double turned = keys_.back().time + std::abs(by) / route.turn_rate;
    const double heading = keys_.back().yaw + by;
    keys_.push_back({turned, from.x(), from.y(), heading});
    keys_.push_back({turned + way.norm() / route.speed, to.x(), to.y(), heading});
  }
}

Trajectory::Key Trajectory::at(double time) const {
  const auto next =
      std::upper_bound(keys_.begin(), keys_.end(), time, [](double t, const Key& key) { return t < key.time; });
  if (next == keys_.begin()) return keys_.front();
  if (next == keys_.end()) return keys_.back();
  const Key &a = *std::prev(next), &b = *next;
  const double s = (time - a.time) / (b.time - a.time);
  return {time, std::lerp(a.x, b.x, s), std::lerp(a.y, b.y, s), std::lerp(a.yaw, b.yaw, s)};
}

Transform Trajectory::T_map_base(double time) const {
  const Key key = at(time);
  if (kind_ != AgentKind::kHeadset) return pose(key.x, key.y, 0, Eigen::Quaterniond(turn(key.yaw)));
  // A person looks around and down, and the head bobs.
  const double sway = 0.75 * std::sin(2 * pi * time / 6.0);
  const double pitch = 0.35 + 0.35 * std::sin(2 * pi * time / 4.3);
  const double bob = 0.02 * std::sin(2 * pi * time / 0.9);
  return pose(key.x, key.y, kEyeHeight + bob, turn(key.yaw + sway) * bow(pitch));
}

Transform Trajectory::T_map_sensor(double time) const {
  Transform T_base_sensor = Transform::Identity();
  if (kind_ == AgentKind::kLidar) T_base_sensor = pose(0, 0, kLidarHeight, Eigen::Quaterniond::Identity());
  if (kind_ == AgentKind::kCamera) T_base_sensor = pose(0.2, 0, kCameraHeight, Eigen::Quaterniond(bow(kCameraPitch)));
  return T_map_base(time) * T_base_sensor;
}

}  // namespace concord
