#include <gtest/gtest.h>

#include "sample_meshes.hpp"
#include "semantic/models/solid_voxels.hpp"
#include "semantic/models/triangle_voxels.hpp"
#include "voxel_oracle.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.05;

Transform turned(double angle, const Eigen::Vector3d& axis, const Eigen::Vector3d& by) {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  T.translation() = by;
  return T;
}

/// In place; by a multiple of the lattice; a little; and every which way.
const std::vector<Transform>& places() {
  static const std::vector<Transform> all{
      Transform::Identity(), turned(0, {0, 0, 1}, {1.0, -2.0, 0.5}), turned(1.5707963267948966, {0, 0, 1}, {0, 0, 0}),
      turned(0.3, {0, 0, 1}, {0.013, 0.021, -0.4}), turned(2.1, {1, -2, 0.5}, {-0.7, 0.3, 0.2})};
  return all;
}

std::set<VoxelIndex> set_of(const BrickMasks& masks) {
  const auto voxels = masks.voxels();
  return {voxels.begin(), voxels.end()};
}

VoxelIndex moved(VoxelIndex v, VoxelIndex d) { return {v.x + d.x, v.y + d.y, v.z + d.z}; }

/// What a walk from outside reaches, told by one step at a time.
std::set<VoxelIndex> reached(const std::set<VoxelIndex>& surface) {
  VoxelIndex low{1 << 20, 1 << 20, 1 << 20}, high{-(1 << 20), -(1 << 20), -(1 << 20)};
  for (const VoxelIndex v : surface) {
    low = {std::min(low.x, v.x - 1), std::min(low.y, v.y - 1), std::min(low.z, v.z - 1)};
    high = {std::max(high.x, v.x + 1), std::max(high.y, v.y + 1), std::max(high.z, v.z + 1)};
  }
  std::set<VoxelIndex> out{low};
  std::vector<VoxelIndex> open{low};
  while (!open.empty()) {
    const VoxelIndex at = open.back();
    open.pop_back();
    for (const VoxelIndex d : {VoxelIndex{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
      const VoxelIndex v = moved(at, d);
      const bool in = v.x >= low.x && v.y >= low.y && v.z >= low.z && v.x <= high.x && v.y <= high.y && v.z <= high.z;
      if (in && !surface.contains(v) && out.insert(v).second) open.push_back(v);
    }
  }
  return out;
}

class Voxelize : public testing::TestWithParam<std::size_t> {};

TEST_P(Voxelize, NoVoxelOfTheSurfaceDiffersFromTheOracle) {
  const SampleMesh sample = sample_meshes()[GetParam()];
  for (const Transform& T : places()) {
    const auto mesh = snap(sample.mesh, {T, 1.0}, kResolution);
    ASSERT_TRUE(mesh);
    EXPECT_EQ(set_of(*surface_of(*mesh)), surface_oracle(*mesh)) << sample.name;
  }
}

TEST_P(Voxelize, NoVoxelOfTheInsideDiffersFromTheOracle) {
  const SampleMesh sample = sample_meshes()[GetParam()];
  for (const Transform& T : places()) {
    const auto mesh = snap(sample.mesh, {T, 1.0}, kResolution);
    ASSERT_TRUE(mesh);
    const auto voxels = voxelize(sample.mesh, {T, 1.0}, kResolution, Fill::kSolid);
    ASSERT_TRUE(voxels);
    ASSERT_EQ(voxels->watertight, sample.watertight) << sample.name;
    const auto surface = set_of(voxels->surface), interior = set_of(voxels->interior);
    const auto box = bounds_of(voxels->surface);
    const std::set<VoxelIndex> outside = sample.watertight ? std::set<VoxelIndex>{} : reached(surface);
    for (std::int32_t x = box->min.x; x <= box->max.x; ++x) {
      for (std::int32_t y = box->min.y; y <= box->max.y; ++y) {
        for (std::int32_t z = box->min.z; z <= box->max.z; ++z) {
          const VoxelIndex v{x, y, z};
          const bool inside =
              !surface.contains(v) && (sample.watertight ? inside_oracle(*mesh, v) : !outside.contains(v));
          ASSERT_EQ(interior.contains(v), inside) << sample.name << " at " << x << " " << y << " " << z;
        }
      }
    }
    for (const VoxelIndex v : interior) {
      ASSERT_TRUE(v.x >= box->min.x && v.x <= box->max.x && v.y >= box->min.y && v.y <= box->max.y &&
                  v.z >= box->min.z && v.z <= box->max.z);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Twenty, Voxelize, testing::Range<std::size_t>(0, 20));

TEST(VoxelizeRule, AFaceBetweenTwoVoxelsBelongsToTheUpperOne) {
  const auto voxels = voxelize(box_mesh({0, 0, 0}, {1, 1, 1}), {}, 0.5, Fill::kSolid);
  ASSERT_TRUE(voxels);
  const auto box = bounds_of(voxels->surface);
  EXPECT_EQ(box->min, (VoxelIndex{0, 0, 0}));
  EXPECT_EQ(box->max, (VoxelIndex{2, 2, 2}));
  EXPECT_EQ(voxels->surface.count() + voxels->interior.count(), 27);
}

TEST(VoxelizeRule, SpaceThatTwoShellsShareIsAHollow) {
  const TriangleMesh twice = joined(box_mesh({0, 0, 0}, {1, 1, 1}), box_mesh({0, 0, 0}, {1, 1, 1}));
  EXPECT_EQ(voxelize(twice, {}, 0.1, Fill::kSolid)->interior.count(), 0);
}

TEST(VoxelizeRefuses, WhatIsBeyondTheMapOrNoNumber) {
  const TriangleMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  Transform far = Transform::Identity();
  far.translation().x() = 5000;
  EXPECT_EQ(voxelize(box, {far, 1.0}, 0.05, Fill::kSolid).error().code, Code::kOutOfBounds);
  EXPECT_EQ(voxelize(box, {Transform::Identity(), 1e9}, 0.05, Fill::kSolid).error().code, Code::kOutOfBounds);
  EXPECT_EQ(voxelize(box, {Transform::Identity(), 0.0}, 0.05, Fill::kSolid).error().code, Code::kBadRequest);
  EXPECT_EQ(voxelize({}, {}, 0.05, Fill::kSolid).error().code, Code::kEmpty);
  TriangleMesh broken = box;
  broken.vertices[3].y() = std::nan("");
  EXPECT_EQ(voxelize(broken, {}, 0.05, Fill::kSolid).error().code, Code::kNotFinite);
  broken = box;
  broken.triangles[1][2] = 8;
  EXPECT_EQ(voxelize(broken, {}, 0.05, Fill::kSolid).error().code, Code::kMalformed);
}

TEST(VoxelizeRefuses, MoreThanItMayFill) {
  // Within the map's bounds, but 60,000 voxels long each way.
  EXPECT_EQ(voxelize(box_mesh({-1500, -1500, -1500}, {1500, 1500, 1500}), {}, 0.05, Fill::kSolid).error().code,
            Code::kTooLarge);
}

}  // namespace
}  // namespace concord
