#include "pose_figures.hpp"

#include <ctime>

#include "planner/se2/pose_check.hpp"
#include "planner/se2/pose_search.hpp"

namespace concord {
namespace {

double now_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

}  // namespace

PoseFigures pose_figures(const PoseCase& c, double turn_radius) {
  PoseFigures figures;
  const Footprint footprint = pose_case_robot();
  const double r = c.resolution;
  const double begin = now_ms();
  PoseSearch search(c.grid, footprint.scaled(1 / r), turn_radius / r * kChordRadius);
  figures.startup_ms = now_ms() - begin;
  for (std::size_t i = 0; i < c.queries.size(); ++i) {
    const auto& [start, goal] = c.queries[i];
    const double asked = now_ms();
    PoseRoute route = search.find({start.p / r, start.yaw}, {goal.p / r, goal.yaw});
    const double found = now_ms();
    figures.ms.push_back(found - asked);
    if (route.outcome != PoseOutcome::kFound) {
      figures.unsolved.push_back(i);
      continue;
    }
    for (Pose& pose : route.poses) pose.p *= r;
    route.poses.front() = start;
    route.poses.back() = goal;
    if (fault_of({c.grid, r, footprint, turn_radius, start, goal}, route.poses)) ++figures.violations;
    figures.check_ms.push_back(now_ms() - found);
    figures.length.push_back(route.length * r);
    ++figures.solved;
    if (route.means != PoseMeans::kGuided) ++figures.sampled;
  }
  return figures;
}

}  // namespace concord
