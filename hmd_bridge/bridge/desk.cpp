#include "bridge/desk.hpp"

#include <algorithm>
#include <cmath>

#include "core/text.hpp"

namespace concord::hmd {
namespace {

constexpr double kPathStep = 0.25;  // metres
constexpr std::size_t kMaxPoints = 4096;
constexpr std::size_t kMaxZones = 64;
constexpr double kClearanceShown = 2.0;  // metres; what is further is as good

/// From a point of the grid to the nearest cell that is not free, at most kClearanceShown. By squares of cells around
/// it, ever larger, until nothing nearer can come.
double clearance_at(const BrickMap& grid, double resolution, const Eigen::Vector2d& p) {
  const VoxelIndex at = voxel_of({p.x(), p.y(), 0}, resolution);
  double least = kClearanceShown;
  const auto look = [&](std::int32_t x, std::int32_t y) {
    if (is_free(grid.at({x, y, 0}))) return;
    const Eigen::Vector2d low(x * resolution, y * resolution);
    const Eigen::Vector2d nearest = p.cwiseMax(low).cwiseMin((low.array() + resolution).matrix());
    least = std::min(least, (p - nearest).norm());
  };
  for (std::int32_t ring = 0; (ring - 1) * resolution < least; ++ring) {
    for (std::int32_t i = -ring; i <= ring; ++i) {
      look(at.x + i, at.y - ring);
      look(at.x + i, at.y + ring);
      look(at.x - ring, at.y + i);
      look(at.x + ring, at.y + i);
    }
  }
  return least;
}

}  // namespace

Granted<Desk::InMap> Desk::place(const Ask& ask, Frame frame) { return place(*hub.find(ask.session), frame); }

Granted<Desk::InMap> Desk::place(const Session& session, Frame frame) {
  if (frame == Frame::kMap) return InMap{};
  if (session.agent.empty())
    return no(Code::kBadFrame, "this client is no agent and has no frame of its own; say agent in hello");
  if (session.tracking_lost)
    return no(Code::kTrackingLost, "the device does not know where it is; look around until it does");
  const AgentState* state = world.agent(session.agent);
  if (state == nullptr || !state->aligned || state->frame_id != session.frame_id) {
    return no(Code::kUnaligned, "where this device's frame lies in the map is not known; align it");
  }
  return InMap{{session.agent, session.frame_id}, state->T_map_agent};
}

Granted<Transform> Desk::in_map(const Ask& ask, Frame frame, const Pose& pose) {
  const auto where = place(ask, frame);
  if (!where) return tl::unexpected(where.error());
  const auto T = from_hmd(pose);
  if (!T) return no(T.error());
  return where->T_map_frame * *T;
}

concord::Path Desk::no_path(const std::string& robot) {
  concord::Path none;
  none.robot = robot;
  none.status = "NO_PATH";
  none.message = "no path is kept for it now; send it somewhere";
  return none;
}

Granted<Path> Desk::show(const Ask& ask, const concord::Path& path, Frame frame) {
  return show(*hub.find(ask.session), path, frame);
}

Granted<Path> Desk::show(const Session& session, const concord::Path& path, Frame frame) {
  const auto where = place(session, frame);
  if (!where) return tl::unexpected(where.error());
  Path out{path.robot,
           cut_to(path.status, 40),
           cut_to(path.message, 400),
           frame,
           {},
           path.length,
           path.least_clearance,
           cut_to(path.id, 80),
           path.plan_number,
           path.map_revision,
           path.active,
           {},
           {},
           {},
           {}};
  const Transform T_frame_map = where->T_map_frame.inverse();
  if (!path.details.empty()) out.seconds = path.details.back().eta;
  for (const std::string& zone : path.zones) {
    if (out.zones.size() < kMaxZones) out.zones.push_back(cut_to(zone, 80));
  }
  if (path.failed_leg >= 0) out.failed_leg = path.failed_leg;
  if (path.nearest)
    out.nearest = array_of(T_frame_map * Eigen::Vector3d(path.nearest->x(), path.nearest->y(), path.zmin));
  const double step = std::max(kPathStep, path.length / (kMaxPoints / 2.0));
  const auto put = [&](const Eigen::Vector3d& p_map) {
    if (out.points.size() >= kMaxPoints) return;
    const double clearance = clearance_at(world.grid().map(), context.site.resolution, p_map.head<2>());
    out.points.push_back({array_of(T_frame_map * p_map), clearance});
  };
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    put(path.points[i]);
    if (i + 1 == path.points.size()) break;
    const Eigen::Vector3d way = path.points[i + 1] - path.points[i];
    const int pieces = static_cast<int>(std::ceil(way.norm() / step));
    for (int k = 1; k < pieces; ++k) put(path.points[i] + way * (static_cast<double>(k) / pieces));
  }
  return out;
}

}  // namespace concord::hmd
