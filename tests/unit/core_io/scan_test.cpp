#include "core/scan.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>
#include <set>

#include "core/ray.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.1;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Transform sensor_at(double x, double y, double z) {
  Transform T = Transform::Identity();
  T.translation() = Eigen::Vector3d(x, y, z);
  return T;
}

BrickMap after(const Scan& scan, BrickMap map = {}) {
  const auto ready = checked(scan, kResolution);
  EXPECT_TRUE(ready.has_value());
  EXPECT_TRUE(integrate(map, kResolution, ready->scan).has_value());
  return map;
}

/// On multiples of 1/8 of a voxel, so that rays along axes, through edges and through corners occur.
rc::Gen<Eigen::Vector3d> arbitrary_point() {
  return rc::gen::exec([] {
    const auto coordinate = [] { return *rc::gen::inRange(-80, 80) / 8.0; };
    return Eigen::Vector3d(coordinate(), coordinate(), coordinate());
  });
}

/// The share of the segment that lies in a cell grown by `margin` on each side; below 0 when it misses it.
double overlap(const Eigen::Vector3d& start, const Eigen::Vector3d& end, VoxelIndex cell, double margin) {
  double enter = 0, leave = 1;
  const std::array<int, 3> low{cell.x, cell.y, cell.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double direction = end[axis] - start[axis];
    const double to_low = low[axis] - margin - start[axis], to_high = low[axis] + 1 + margin - start[axis];
    if (direction == 0) {
      if (to_low > 0 || to_high < 0) return -1;
      continue;
    }
    enter = std::max(enter, std::min(to_low / direction, to_high / direction));
    leave = std::min(leave, std::max(to_low / direction, to_high / direction));
  }
  return leave - enter;
}

RC_GTEST_PROP(Ray, VisitsTheCellsThatTheSegmentCrossesInAFaceConnectedRow, ()) {
  const Eigen::Vector3d start = *arbitrary_point(), end = *arbitrary_point();
  std::vector<VoxelIndex> row;
  walk_ray(start, end, [&](VoxelIndex v) { row.push_back(v); });
  const VoxelIndex first = voxel_of(start, 1.0), last = voxel_of(end, 1.0);
  RC_ASSERT(row.size() == steps_between(first, last));
  row.push_back(last);
  RC_ASSERT(row.front() == first);
  const std::set<VoxelIndex> cells(row.begin(), row.end());
  RC_ASSERT(cells.size() == row.size());
  for (std::size_t i = 0; i < row.size(); ++i) {
    RC_ASSERT(overlap(start, end, row[i], 1e-9) >= 0);
    if (i > 0) RC_ASSERT(steps_between(row[i - 1], row[i]) == 1u);
  }
  for (int z = std::min(first.z, last.z); z <= std::max(first.z, last.z); ++z) {
    for (int y = std::min(first.y, last.y); y <= std::max(first.y, last.y); ++y) {
      for (int x = std::min(first.x, last.x); x <= std::max(first.x, last.x); ++x) {
        if (overlap(start, end, {x, y, z}, -1e-9) > 0) RC_ASSERT(cells.contains({x, y, z}));
      }
    }
  }
}

TEST(Scan, ARayFreesWhatItCrossesAndOccupiesItsEnd) {
  const BrickMap map = after({sensor_at(0.05, 0.05, 0.05), 0, {{1.05f, 0.05f, 0.05f}}});
  EXPECT_EQ(map.known_count(), 11u);
  for (int x = 0; x < 10; ++x) EXPECT_EQ(map.at({x, 0, 0}), kMiss) << x;
  EXPECT_EQ(map.at({10, 0, 0}), kHit);
}

TEST(Scan, BeyondRangeARayFreesUpToItAndOccupiesNothing) {
  const BrickMap map = after({sensor_at(0.05, 0.05, 0.05), 0.5, {{-9.0f, 0.05f, 0.05f}}});
  EXPECT_EQ(map.occupied_count(), 0u);
  EXPECT_EQ(map.known_count(), 5u);
  EXPECT_EQ(map.at({-4, 0, 0}), kMiss);
  EXPECT_EQ(map.at({-5, 0, 0}), kUnknown);
}

TEST(Scan, WithinOneScanOccupiedWinsAndEachCellCountsOnce) {
  // Two rays through the same cells, one ending where the other passes.
  const BrickMap map = after({sensor_at(0.05, 0.05, 0.05), 0, {{1.05f, 0.05f, 0.05f}, {0.55f, 0.05f, 0.05f}}});
  EXPECT_EQ(map.at({3, 0, 0}), kMiss);
  EXPECT_EQ(map.at({5, 0, 0}), kHit);
  EXPECT_EQ(map.at({10, 0, 0}), kHit);
}

TEST(Scan, ValuesAddUpAndStayWithinTheClamps) {
  const Scan scan{sensor_at(0.05, 0.05, 0.05), 0, {{0.25f, 0.05f, 0.05f}}};
  BrickMap map = after(scan);
  map = after(scan, std::move(map));
  EXPECT_EQ(map.at({2, 0, 0}), 2 * kHit);
  EXPECT_EQ(map.at({1, 0, 0}), 2 * kMiss);
  for (int i = 0; i < 10; ++i) map = after(scan, std::move(map));
  EXPECT_EQ(map.at({2, 0, 0}), kOccupied);
  EXPECT_EQ(map.at({1, 0, 0}), kFree);
  EXPECT_TRUE(integrate(map, kResolution, scan)->empty()) << "a scan that changes nothing";
}

TEST(Scan, WithoutASensorPosePointsOnlyOccupy) {
  const BrickMap map = after({std::nullopt, 0.1, {{1.05f, 0.05f, 0.05f}, {-1.05f, 0.05f, 0.05f}}});
  EXPECT_EQ(map.known_count(), 2u);
  EXPECT_EQ(map.at({-11, 0, 0}), kHit);
}

TEST(Scan, AnswersTheChangedBricksInOrder) {
  const Scan scan{sensor_at(0.05, 0.05, 0.05), 0, {{-1.05f, 0.05f, 0.05f}, {1.05f, 0.05f, 0.05f}}};
  BrickMap map;
  const auto changed = integrate(map, kResolution, checked(scan, kResolution)->scan);
  ASSERT_TRUE(changed.has_value());
  EXPECT_EQ(*changed, (std::vector<BrickIndex>{{-2, 0, 0}, {-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}));
}

RC_GTEST_PROP(Scan, TheOrderOfPointsDoesNotMatter, ()) {
  Scan scan{sensor_at(0.03, 0.02, 0.01), *rc::gen::element(0.0, 0.6), {}};
  const auto points = *rc::gen::container<std::vector<Eigen::Vector3d>>(arbitrary_point());
  for (const auto& p : points) scan.points.push_back((p * kResolution).cast<float>());
  const BrickMap map = after(scan);
  std::reverse(scan.points.begin(), scan.points.end());
  RC_ASSERT(after(scan) == map);
}

TEST(Scan, PointsThatAreNoneAreSkippedAndCounted) {
  const Scan scan{
      sensor_at(0, 0, 0), 0, {{kNan, 0, 0}, {0, kInfinity, 0}, {0, 0, -kInfinity}, {1e30f, 0, 0}, {0.5f, 0.5f, 0.5f}}};
  const auto ready = checked(scan, kResolution);
  ASSERT_TRUE(ready.has_value());
  EXPECT_EQ(ready->skipped, 4u);
  EXPECT_EQ(ready->scan.points.size(), 1u);
}

TEST(Scan, RefusesPosesAndRangesThatAreNone) {
  Scan scan{sensor_at(std::numeric_limits<double>::quiet_NaN(), 0, 0), 0, {}};
  EXPECT_EQ(checked(scan, kResolution).error().code, Code::kNotFinite);
  scan.T_agent_sensor = sensor_at(1e9, 0, 0);
  EXPECT_EQ(checked(scan, kResolution).error().code, Code::kOutOfBounds);
  scan.T_agent_sensor = sensor_at(0, 0, 0);
  for (const double range : {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    scan.max_range = range;
    EXPECT_EQ(checked(scan, kResolution).error().code, Code::kNotFinite);
  }
}

TEST(Scan, RefusesMorePointsOrStepsThanItsLimits) {
  Scan scan{std::nullopt, 0, std::vector<Eigen::Vector3f>(kMaxScanPoints + 1, Eigen::Vector3f::Zero())};
  EXPECT_EQ(checked(scan, kResolution).error().code, Code::kTooLarge);
  scan.points.assign(kMaxScanPoints, Eigen::Vector3f(60.0f, 0, 0));
  EXPECT_TRUE(checked(scan, kResolution).has_value()) << "no rays";
  scan.T_agent_sensor = sensor_at(0, 0, 0);
  EXPECT_EQ(checked(scan, kResolution).error().code, Code::kTooLarge);
  scan.max_range = 10.0;
  EXPECT_TRUE(checked(scan, kResolution).has_value());
}

TEST(Scan, RaysEndAtTheStatedLength) {
  const BrickMap map = after({sensor_at(0.05, 0.05, 0.05), 0, {{2e3f, 0.05f, 0.05f}}});
  EXPECT_EQ(map.known_count(), static_cast<std::size_t>(kMaxRayLength));
  EXPECT_EQ(map.occupied_count(), 0u);
}

}  // namespace
}  // namespace concord
