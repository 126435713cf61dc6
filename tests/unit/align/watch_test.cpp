#include <gtest/gtest.h>

#include <thread>

#include "align/align_task.hpp"
#include "align/drift_watch.hpp"
#include "align/workers.hpp"
#include "rooms.hpp"

namespace concord::test {
namespace {

/// Two who were aligned rightly, of whom one has slipped since.
AgentLayers slipped(const Transform& T_slip) {
  AgentLayers layers;
  const auto add = [&](const std::string& agent, const Points& points, const Transform& T_map_agent) {
    AgentLayer& layer = layers[agent];
    layer.frame_id = "frame1";
    layer.map = voxels_of(points);
    layer.revision = 1;
    layer.synced = true;
    layer.T_map_agent = T_map_agent;
  };
  add("robot1", left_part(), Transform::Identity());
  add("robot2", right_part(), T_slip * kT_left_right);
  return layers;
}

/// Turned about the agent's middle, then shifted.
Transform slip_of(double metres, double heading, double yaw) {
  const Eigen::Vector3d middle(0.6, 0.0, 1.3);
  return transform(metres * std::cos(heading), metres * std::sin(heading), 0, 0) *
         Transform(Eigen::Translation3d(middle)) * transform(0, 0, 0, yaw) * Transform(Eigen::Translation3d(-middle));
}

/// However far one slips, in whatever direction: people are offered the right place, or told that it lies wrong.
TEST(CarryOut, NoSlipIsMetWithSilence) {
  int offered = 0;
  int count = 0;
  for (const double metres : {0.15, 0.25, 0.4, 0.6, 1.0, 1.5}) {
    for (int direction = 0; direction < 3; ++direction) {
      const double turn = degrees(direction == 1 ? 0.0 : 4.0 * direction * (metres < 0.5 ? 1.0 : -1.5));
      const Transform T_slip = slip_of(metres, 2.1 * direction + metres, turn);
      const auto task = make_recheck("robot2", slipped(T_slip), {kResolution, Policy::kMean});
      ASSERT_TRUE(task);
      const auto found = carry_out(*task, 2);
      ASSERT_TRUE(found);
      ++count;
      EXPECT_TRUE(found->accepted() || contradicts(*found))
          << metres << " m, direction " << direction << ": " << found->message;
      if (!found->accepted()) continue;
      ++offered;
      EXPECT_LT(metres_off(found->T_target_source, kT_left_right), 0.15) << metres << " m, direction " << direction;
      EXPECT_TRUE(
          slip_between(*task->T_target_source, found->T_target_source, task->p_source_middle).is_large(kResolution))
          << metres << " m, direction " << direction;
    }
  }
  EXPECT_GE(4 * offered, 3 * count) << "told that something is wrong, but not what";
}

TEST(CarryOut, OfWhoLiesRightNothingIsSaid) {
  for (const char* agent : {"robot1", "robot2"}) {
    const auto task = make_recheck(agent, slipped(Transform::Identity()), {kResolution, Policy::kMean});
    ASSERT_TRUE(task);
    const auto found = carry_out(*task, 2);
    ASSERT_TRUE(found);
    EXPECT_FALSE(contradicts(*found)) << agent << ": " << found->message;
    const Slip slip = slip_between(*task->T_target_source, found->T_target_source, task->p_source_middle);
    EXPECT_FALSE(slip.is_large(kResolution)) << agent << ": " << found->message;
  }
}

TEST(CarryOut, OfACupboardThatWasMovedPeopleAreTold) {
  AgentLayers layers = slipped(Transform::Identity());
  const auto with_cupboard = [](Points points, const Eigen::Vector3d& low, const Transform& T) {
    Points cupboard;
    add_box(cupboard, low, low + Eigen::Vector3d(0.8, 0.4, 1.6), false);
    for (const Eigen::Vector3f& p : moved(cupboard, T)) points.push_back(p);
    return voxels_of(points);
  };
  layers.at("robot1").map = with_cupboard(room(), {-0.6, 0.7, 0.0}, Transform::Identity());
  layers.at("robot2").map = with_cupboard(right_part(), {-0.2, -0.9, 0.0}, kT_left_right.inverse());
  const auto task = make_recheck("robot2", layers, {kResolution, Policy::kMean});
  ASSERT_TRUE(task);
  const auto found = carry_out(*task, 2);
  ASSERT_TRUE(found);
  EXPECT_TRUE(contradicts(*found)) << found->message;
}

TEST(CarryOut, EndsWhenItIsStopped) {
  const auto task = make_recheck("robot2", slipped(Transform::Identity()), {kResolution, Policy::kMean});
  ASSERT_TRUE(task);
  std::stop_source stop;
  stop.request_stop();
  const auto found = carry_out(*task, 2, stop.get_token());
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, Code::kExpired);
  EXPECT_TRUE(carry_out(*task, 2)) << "the stop was for one alone";
}

TEST(Workers, StopBetweenTwoChunks) {
  for (const int threads : {1, 2}) {
    std::stop_source stop;
    const StopScope scope(stop.get_token());
    std::atomic<int> done = 0;
    const auto work = [&](std::size_t) {
      if (++done == 3) stop.request_stop();
    };
    EXPECT_THROW(for_each_chunk(threads, 1000, work), Stopped);
    EXPECT_LT(done, 1000);
    EXPECT_THROW(for_each_chunk(threads, 1, work), Stopped);
  }
  int after = 0;
  for_each_chunk(1, 3, [&](std::size_t) { ++after; });
  EXPECT_EQ(after, 3);
}

}  // namespace
}  // namespace concord::test
