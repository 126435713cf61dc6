// Translators of paths, and of who asks for them.

#include <concord/path_request_t.hpp>
#include <concord/path_t.hpp>
#include <concord/path_watch_t.hpp>

#include <cmath>

#include "bus/translate.hpp"

namespace concord {
namespace {

using wire::bad;

constexpr std::int64_t kMaxPathPoints = 1'000'000;
constexpr std::int64_t kMaxZonesOfAPath = 64;
constexpr std::int64_t kTitleBytes = 80;

constexpr double kFar = 10'000;  ///< metres

bool is_near(const Eigen::Vector2d& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < kFar; }

bool is_finite(const Path& path) {
  const auto fine = [](const PathPoint& point) {
    return std::isfinite(point.yaw) && std::isfinite(point.clearance) && std::isfinite(point.eta);
  };
  return wire::all_finite(path.points) && std::all_of(path.details.begin(), path.details.end(), fine) &&
         std::isfinite(path.length) && std::isfinite(path.least_clearance) && std::isfinite(path.radius) &&
         std::isfinite(path.zmin) && std::isfinite(path.zmax) && (!path.nearest || path.nearest->allFinite());
}

}  // namespace

Bytes encode(const PathRequest& value, std::int64_t utime) {
  path_request_t out;
  out.utime = utime;
  out.request_id = value.id;
  out.op = value.op == PathRequest::Op::kCancel ? path_request_t::CANCEL : path_request_t::PLAN;
  out.robot = value.robot;
  out.has_start = value.start.has_value();
  const Eigen::Vector2d start = value.start.value_or(Eigen::Vector2d::Zero());
  for (int i = 0; i < 2; ++i) {
    out.start[i] = start[i];
    out.goal[i] = value.goal[i];
  }
  out.radius = value.radius;
  out.keep_active = value.keep_active;
  out.count = static_cast<std::int32_t>(value.waypoints.size());
  for (const Eigen::Vector2d& p : value.waypoints) {
    out.waypoint_x.push_back(p.x());
    out.waypoint_y.push_back(p.y());
  }
  return wire::to_bytes(out);
}

template <>
Decoded<PathRequest> decode<PathRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8),
                                          text(wire::kIdLength),
                                          fixed(1),
                                          text(wire::kNameLength),
                                          fixed(1 + 16 + 16 + 8 + 1),
                                          count(kMaxWaypoints),
                                          array(8),
                                          array(8)};
  const auto in = wire::request_from_bytes<path_request_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  if (const auto robot = wire::agent_of(in->robot); !robot) return bad(robot.error(), in->request_id);
  PathRequest out;
  out.id = in->request_id;
  out.robot = in->robot;
  if (in->op == path_request_t::CANCEL) {
    out.op = PathRequest::Op::kCancel;
    return out;
  }
  if (in->op != path_request_t::PLAN) return bad(Code::kBadRequest, "op must be PLAN or CANCEL", out.id);
  out.goal = {in->goal[0], in->goal[1]};
  out.radius = in->radius;
  out.keep_active = in->keep_active != 0;
  if (in->has_start) out.start = Eigen::Vector2d(in->start[0], in->start[1]);
  for (std::size_t i = 0; i < in->waypoint_x.size(); ++i) {
    out.waypoints.emplace_back(in->waypoint_x[i], in->waypoint_y[i]);
  }
  if (!is_near(out.goal) || (out.start && !is_near(*out.start)) ||
      !std::all_of(out.waypoints.begin(), out.waypoints.end(), is_near)) {
    return bad(Code::kNotFinite, "start, waypoints and goal must be finite, in metres, within 10 km", out.id);
  }
  if (!(out.radius >= 0 && out.radius <= 10)) {
    return bad(Code::kBadRequest, "radius must lie between 0 and 10 m", out.id);
  }
  return out;
}

Bytes encode(const PathWatch& value, std::int64_t utime) {
  path_watch_t out;
  out.utime = utime;
  out.request_id = value.id;
  out.robot = value.robot;
  out.frame_agent = value.frame_agent;
  return wire::to_bytes(out);
}

template <>
Decoded<PathWatch> decode<PathWatch>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kIdLength), text(wire::kNameLength),
                                          text(wire::kNameLength)};
  const auto in = wire::request_from_bytes<path_watch_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  if (!in->robot.empty() && !is_name(in->robot)) {
    return bad(Code::kBadName, std::string("robot must be empty or ") + kNameRule, in->request_id);
  }
  if (const auto agent = wire::agent_of(in->frame_agent); !agent) return bad(agent.error(), in->request_id);
  return PathWatch{in->request_id, in->robot, in->frame_agent};
}

Bytes encode(const Path& value) {
  path_t out;
  out.utime = value.utime;
  out.request_id = value.id;
  out.robot = value.robot;
  out.status = value.status;
  out.message = wire::clipped(value.message);
  out.edit_id = value.edit_id;
  out.frame_agent = value.frame_agent;
  out.frame_id = value.frame_id;
  out.path_id = value.path_id;
  out.superseded = value.superseded;
  out.map_revision = value.map_revision;
  out.plan_number = value.plan_number;
  out.active = value.active;
  out.length = value.length;
  out.least_clearance = value.least_clearance;
  out.radius = value.radius;
  out.zmin = value.zmin;
  out.zmax = value.zmax;
  out.failed_leg = value.failed_leg;
  out.has_nearest = value.nearest.has_value();
  for (int i = 0; i < 2; ++i) out.nearest[i] = value.nearest ? (*value.nearest)[i] : 0.0;
  out.zones = value.zones;
  if (out.zones.size() > kMaxZonesOfAPath) out.zones.resize(kMaxZonesOfAPath);
  out.zone_count = static_cast<std::int32_t>(out.zones.size());
  wire::put_points(value.points, out);
  for (std::size_t i = 0; i < value.points.size(); ++i) {
    const PathPoint point = i < value.details.size() ? value.details[i] : PathPoint{};
    out.yaw.push_back(point.yaw);
    out.clearance.push_back(point.clearance);
    out.leg.push_back(point.leg);
    out.eta.push_back(point.eta);
  }
  return wire::to_bytes(out);
}

template <>
Decoded<Path> decode<Path>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8),
                                          text(wire::kIdLength),
                                          text(wire::kNameLength),
                                          text(wire::kNameLength),
                                          text(wire::kMessageLength),
                                          text(wire::kIdLength),
                                          text(wire::kNameLength),
                                          text(wire::kNameLength),
                                          fixed(8 + 8 + 8 + 8 + 1 + 5 * 8 + 4 + 1 + 16),
                                          count(kMaxZonesOfAPath),
                                          texts(kTitleBytes),
                                          count(kMaxPathPoints),
                                          array(3 * 8),
                                          array(2 * 8),
                                          array(4),
                                          array(8)};
  const auto in = wire::from_bytes<path_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  Path out;
  out.id = in->request_id;
  out.robot = in->robot;
  out.status = in->status;
  out.message = in->message;
  out.edit_id = in->edit_id;
  out.frame_agent = in->frame_agent;
  out.frame_id = in->frame_id;
  out.path_id = in->path_id;
  out.superseded = in->superseded;
  out.length = in->length;
  out.least_clearance = in->least_clearance;
  out.radius = in->radius;
  out.zmin = in->zmin;
  out.zmax = in->zmax;
  out.failed_leg = in->failed_leg;
  if (in->has_nearest) out.nearest = Eigen::Vector2d(in->nearest[0], in->nearest[1]);
  out.zones = in->zones;
  out.map_revision = in->map_revision;
  out.plan_number = in->plan_number;
  out.active = in->active != 0;
  out.utime = in->utime;
  out.points = wire::points_of<Eigen::Vector3d>(*in);
  for (std::size_t i = 0; i < out.points.size(); ++i) {
    out.details.push_back({in->yaw[i], in->clearance[i], in->leg[i], in->eta[i]});
  }
  if (!is_finite(out)) return bad(Code::kNotFinite, "a path has a number that is not finite");
  return out;
}

}  // namespace concord
