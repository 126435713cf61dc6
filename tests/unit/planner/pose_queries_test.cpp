// A robot of 1.2 x 0.8 m in other people's buildings: ../shared/data, whose README names the sources.
#include <filesystem>

#include <gtest/gtest.h>

#include "planner/se2/pose_check.hpp"
#include "planner/se2/pose_search.hpp"
#include "pose_cases.hpp"

namespace concord {
namespace {

class PoseQueries : public testing::TestWithParam<double> {};

TEST_P(PoseQueries, AllAreSolvedAndStand) {
  const std::filesystem::path data = CONCORD_SHARED_DATA;
  if (!std::filesystem::exists(data / "buildings")) GTEST_SKIP() << "no real maps in " << data;
  const Footprint footprint = pose_case_robot();
  for (const PoseCase& c : pose_cases(data, 20)) {
    const double r = c.resolution;
    PoseSearch search(c.grid, footprint.scaled(1 / r), GetParam() / r * kChordRadius);
    ASSERT_EQ(c.queries.size(), 20U);
    for (const auto& [start, goal] : c.queries) {
      PoseRoute route = search.find({start.p / r, start.yaw}, {goal.p / r, goal.yaw});
      ASSERT_EQ(route.outcome, PoseOutcome::kFound) << c.name << ": " << start.p.transpose();
      for (Pose& pose : route.poses) pose.p *= r;
      route.poses.front() = start;
      route.poses.back() = goal;
      EXPECT_EQ(fault_of({c.grid, r, footprint, GetParam(), start, goal}, route.poses), std::nullopt) << c.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(TurnRadii, PoseQueries, testing::Values(0.4, 0.0));

}  // namespace
}  // namespace concord
