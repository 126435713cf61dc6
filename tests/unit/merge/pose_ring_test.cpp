#include "merge/pose_ring.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace concord {
namespace {

Transform at(double x, double yaw) {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation().x() = x;
  return T;
}

TEST(PoseRing, IsBetweenTwoPosesInProportion) {
  PoseRing ring;
  ASSERT_TRUE(ring.add(1'000'000, at(1, 0)));
  ASSERT_TRUE(ring.add(2'000'000, at(3, 1)));
  EXPECT_TRUE(ring.at(1'500'000)->isApprox(at(2, 0.5)));
  EXPECT_TRUE(ring.at(1'000'000)->isApprox(at(1, 0)));
  EXPECT_TRUE(ring.at(2'000'000)->isApprox(at(3, 1)));
}

TEST(PoseRing, ReachesALittleBeyondItsEnds) {
  PoseRing ring;
  EXPECT_EQ(ring.at(0).error().code, Code::kStale);
  ASSERT_TRUE(ring.add(1'000'000, at(1, 0)));
  ASSERT_TRUE(ring.add(2'000'000, at(3, 0)));
  EXPECT_TRUE(ring.at(800'000)->isApprox(at(1, 0)));
  EXPECT_TRUE(ring.at(2'200'000)->isApprox(at(3, 0)));
  EXPECT_EQ(ring.at(799'999).error().code, Code::kStale);
  EXPECT_EQ(ring.at(2'200'001).error().code, Code::kStale);
}

TEST(PoseRing, ForgetsWhatIsOld) {
  PoseRing ring;
  for (int second = 0; second <= 40; ++second) ASSERT_TRUE(ring.add(second * 1'000'000, at(second, 0)));
  EXPECT_EQ(ring.at(9'000'000).error().code, Code::kStale);
  EXPECT_TRUE(ring.at(10'500'000)->isApprox(at(10.5, 0)));
}

TEST(PoseRing, BeginsAnewWhenTheClockGoesBack) {
  PoseRing ring;
  ASSERT_TRUE(ring.add(5'000'000, at(1, 0)));
  ASSERT_TRUE(ring.add(1'000'000, at(2, 0)));
  EXPECT_FALSE(ring.at(5'000'000));
  EXPECT_TRUE(ring.at(1'000'000)->isApprox(at(2, 0)));
}

TEST(PoseRing, RefusesWhatIsNoTime) {
  constexpr auto kLeast = std::numeric_limits<std::int64_t>::min();
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  PoseRing ring;
  ASSERT_TRUE(ring.add(1'000'000, at(1, 0)));
  for (const std::int64_t none : {kLeast, kLeast + 1, std::int64_t{-1}, PoseRing::kLatest + 1, kMost}) {
    const auto added = ring.add(none, at(2, 0));
    ASSERT_FALSE(added) << none;
    EXPECT_EQ(added.error().code, Code::kBadRequest);
    EXPECT_EQ(ring.at(none).error().code, Code::kStale);
  }
  EXPECT_TRUE(ring.at(1'000'000)->isApprox(at(1, 0))) << "nothing has changed";
  ASSERT_TRUE(ring.add(PoseRing::kLatest, at(3, 0)));
  EXPECT_TRUE(ring.at(PoseRing::kLatest)->isApprox(at(3, 0)));
  ASSERT_TRUE(ring.add(0, at(4, 0)));
  EXPECT_TRUE(ring.at(0)->isApprox(at(4, 0)));
}

TEST(PoseRing, KeepsTheNewestOfManyNearInTime) {
  PoseRing ring;
  for (int i = 0; i <= 100'000; ++i) ASSERT_TRUE(ring.add(i, at(i, 0)));
  EXPECT_TRUE(ring.at(100'000)->isApprox(at(100'000, 0)));
  EXPECT_NEAR(ring.at(50'000)->translation().x(), 50'000, 1) << "in proportion between those that were kept";
}

}  // namespace
}  // namespace concord
