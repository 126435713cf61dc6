#include "semantic/detections/find_model.hpp"

#include <gtest/gtest.h>

#include "sample_meshes.hpp"
#include "semantic/models/solid_voxels.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.05;

Transform placed(double x, double y, double yaw) {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(x, y, 0);
  return T;
}

/// A room of 6 x 6 m with a floor, two walls, a table and boxes, and what is put into it.
BrickMap room_with(const std::vector<std::pair<TriangleMesh, Transform>>& things) {
  BrickMasks all;
  const auto add = [&](const TriangleMesh& mesh, const Transform& T) {
    all.insert(voxelize(mesh, {T, 1.0}, kResolution, Fill::kSurface)->surface);
  };
  const Transform here = Transform::Identity();
  add(box_mesh({-3, -3, -0.1}, {3, 3, -0.05}), here);
  add(box_mesh({-3, -3, 0}, {-2.95, 3, 2.5}), here);
  add(box_mesh({-3, 2.95, 0}, {3, 3, 2.5}), here);
  add(box_mesh({-1.5, 1.5, 0.7}, {0.5, 2.3, 0.75}), here);
  add(box_mesh({1.8, 1.8, 0}, {2.4, 2.4, 0.6}), here);
  for (const auto& [mesh, T] : things) add(mesh, T);
  BrickMap map = all.to_map(kOccupied);
  return map;
}

double apart(const FoundModel& found, const Transform& T) {
  return (found.T_map_model.translation() - T.translation()).norm();
}

TEST(FindModel, FindsEachPumpWhereverItStandsAndNothingElse) {
  const Transform one = placed(-1.2, -1.4, 0.7), two = placed(1.3, -0.6, 3.9);
  const auto found = find_model(pump_mesh(), 1.0, room_with({{pump_mesh(), one}, {pump_mesh(), two}}), kResolution);
  ASSERT_TRUE(found) << found.error().message;
  for (const FoundModel& model : *found) {
    SCOPED_TRACE(::testing::Message() << model.T_map_model.translation().transpose() << " score " << model.score);
    EXPECT_TRUE(apart(model, placed(-1.2, -1.4, 0)) < 0.1 || apart(model, placed(1.3, -0.6, 0)) < 0.1) << model.matched;
  }
  ASSERT_EQ(found->size(), 2U);
  for (const Transform& T : {one, two}) {
    const bool has = std::ranges::any_of(*found, [&](const FoundModel& f) {
      return apart(f, T) < 0.06 && Eigen::AngleAxisd(T.linear().transpose() * f.T_map_model.linear()).angle() < 0.1;
    });
    EXPECT_TRUE(has) << T.translation().transpose();
  }
}

TEST(FindModel, FindsNothingWhereThereIsNone) {
  const auto found = find_model(pump_mesh(), 1.0, room_with({}), kResolution);
  ASSERT_TRUE(found);
  for (const FoundModel& one : *found) ADD_FAILURE() << one.T_map_model.translation().transpose() << " " << one.score;
  EXPECT_TRUE(find_model(pump_mesh(), 1.0, BrickMap(), kResolution)->empty());
}

TEST(FindModel, WhatIsThereBesidesSpeaksAgainstIt) {
  const Transform at = placed(0, -1, 0);
  const auto best = [&](const BrickMap& map) {
    const auto found = find_model(pump_mesh(), 1.0, map, kResolution, {Eigen::Vector3d::UnitZ(), 0.0, 20});
    FoundModel there;
    for (const FoundModel& one : found.value()) {
      if (apart(one, at) < 0.2 && one.score > there.score) there = one;
    }
    return there;
  };
  const FoundModel alone = best(room_with({{pump_mesh(), at}}));
  // A crate from the block up to the pipe's end: all of the pump is on it or in it.
  const FoundModel crated = best(room_with({{pump_mesh(), at}, {box_mesh({-0.4, -0.2, 0}, {0.4, 0.2, 1.0}), at}}));
  EXPECT_GT(alone.explained, 0.9);
  EXPECT_LT(crated.explained, 0.8);
  EXPECT_LT(crated.score, 0.75);
  EXPECT_GT(alone.score, 0.75);
}

TEST(FindModel, FreeSpaceSpeaksAgainstIt) {
  const Transform at = placed(0, -1, 0);
  BrickMap map = room_with({{box_mesh({-0.4, -0.2, 0}, {0.4, 0.2, 0.3}), at}});  // the block alone
  // The best of those that stand on the block.
  const auto score = [&] {
    double best = 0;
    const auto found = find_model(pump_mesh(), 1.0, map, kResolution, {Eigen::Vector3d::UnitZ(), 0.0, 20});
    for (const FoundModel& one : found.value()) best = apart(one, at) < 0.4 ? std::max(best, one.score) : best;
    return best;
  };
  const double without = score();
  EXPECT_GT(without, 0.3);
  for (std::int32_t z = 7; z < 25; ++z) {
    for (std::int32_t y = -30; y < -10; ++y) {
      for (std::int32_t x = -14; x < 14; ++x) {
        const BrickIndex brick = brick_of({x, y, z});
        DenseBrick dense;
        dense.fill(kUnknown);
        if (const Brick* there = map.find(brick)) there->to_dense(dense);
        LogOdds& value = dense[static_cast<std::size_t>(local_of(VoxelIndex{x, y, z}))];
        if (!is_known(value)) value = kFree;
        map.set(brick, Brick::from_dense(dense));
      }
    }
  }
  EXPECT_LT(score(), 0.8 * without);
}

TEST(FindModel, AModelWithAnotherUpIsSoughtUpright) {
  TriangleMesh lying = pump_mesh();
  for (Eigen::Vector3d& p : lying.vertices) p = {p.x(), p.z(), -p.y()};  // y up, as glTF has it
  const Transform at = placed(-1.2, -1.4, 0.7);
  const auto found =
      find_model(lying, 1.0, room_with({{pump_mesh(), at}}), kResolution, {Eigen::Vector3d::UnitY(), 0.7, 5});
  ASSERT_EQ(found->size(), 1U);
  EXPECT_LT(apart(found->at(0), at), 0.06);
  EXPECT_GT((found->at(0).T_map_model.linear() * Eigen::Vector3d::UnitY()).z(), 0.99);
}

}  // namespace
}  // namespace concord
