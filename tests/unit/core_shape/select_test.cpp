#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "random_shapes.hpp"

namespace concord {
namespace {

constexpr std::int64_t kMost = 1'000'000;
const Transform kHere = Transform::Identity();

std::vector<VoxelIndex> block(const VoxelIndex& first, const VoxelIndex& last) {
  const VoxelBox box{first, last};
  return expand(std::span(&box, 1), kMost).value();
}

Code refusal(const Shape& shape, const Transform& T = kHere, double resolution = 0.05, std::int64_t most = kMost) {
  const auto voxels = select(shape, T, resolution, most);
  EXPECT_FALSE(voxels.has_value());
  return voxels ? Code::kIo : voxels.error().code;
}

std::vector<VoxelIndex> selected(const Shape& shape, double resolution = 0.05) {
  const auto voxels = select(shape, kHere, resolution, kMost);
  EXPECT_TRUE(voxels.has_value()) << voxels.error().message;
  return voxels.value_or(std::vector<VoxelIndex>{});
}

/// The same box as each kind of volume.
std::vector<Shape> kinds_of(const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  OrientedBox around{Transform::Identity(), max - min};
  around.T_frame_box.translation() = (min + max) / 2;
  return {Box{min, max}, around,
          Prism{{{min.x(), min.y()}, {max.x(), min.y()}, {max.x(), max.y()}, {min.x(), max.y()}}, min.z(), max.z()}};
}

RC_GTEST_PROP(SelectVolume, OnTheLatticeTakesExactlyItsVoxelsHoweverItIsTurned, ()) {
  const double r = *rc::gen::element(0.05, 0.1, 0.03, 1.0 / 3, 0.07);
  const auto index = [&](int reach) { return *rc::gen::inRange(-reach, reach + 1); };
  const int far = *rc::gen::element(10, 20'000);
  const Eigen::Vector3i min(index(far), index(far), index(far));
  const Eigen::Vector3i max = min + Eigen::Vector3i(1 + std::abs(index(4)), 1 + std::abs(index(4)), 1);
  // Seen from a frame that is turned by right angles and lies on the lattice too.
  Transform T_map_frame = Transform::Identity();
  T_map_frame.linear() = any_right_turn();
  T_map_frame.translation() = r * Eigen::Vector3d(index(20), index(20), index(20));
  const Eigen::Vector3d a = T_map_frame.inverse() * (r * min.cast<double>());
  const Eigen::Vector3d b = T_map_frame.inverse() * (r * max.cast<double>());
  const auto expected = block({min.x(), min.y(), min.z()}, {max.x() - 1, max.y() - 1, max.z() - 1});
  for (const Shape& shape : kinds_of(a.cwiseMin(b), a.cwiseMax(b))) {
    const auto voxels = select(shape, T_map_frame, r, kMost);
    RC_ASSERT(voxels.has_value());
    RC_ASSERT(*voxels == expected);
  }
}

RC_GTEST_PROP(SelectVolume, OneBoxGivesTheSameVoxelsAsEveryKindOfVolume, ()) {
  const Eigen::Vector3d a = any_point(0.5), b = any_point(0.5);
  RC_PRE((a - b).cwiseAbs().minCoeff() > 1e-4);
  const Transform T_map_frame = any_transform(0.5);
  const auto kinds = kinds_of(a.cwiseMin(b), a.cwiseMax(b));
  const auto voxels = select(kinds[0], T_map_frame, 0.05, kMost);
  RC_ASSERT(voxels.has_value());
  for (const Shape& shape : kinds) RC_ASSERT(select(shape, T_map_frame, 0.05, kMost).value() == *voxels);
}

TEST(SelectVolume, APaneTakesTheLayerThatItRunsThrough) {
  for (const Shape& pane : kinds_of({0.11, 0, 0}, {0.13, 1, 2}))
    EXPECT_EQ(selected(pane), block({2, 0, 0}, {2, 19, 39}));
  for (const Shape& pane : kinds_of({0.09, 0, 0}, {0.11, 1, 2}))
    EXPECT_EQ(selected(pane), block({1, 0, 0}, {2, 19, 39}));
}

TEST(SelectVolume, AFlatSideOnAFaceTakesTheUpperLayer) {
  const auto upper = block({0, 0, 3}, {19, 19, 3});
  Transform upside_down = kHere;
  upside_down.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  for (const Shape& shape : kinds_of({0, 0, 0.15}, {1, 1, 0.15})) EXPECT_EQ(selected(shape), upper);
  for (const Shape& shape : kinds_of({0, -1, -0.15}, {1, 0, -0.15})) {
    EXPECT_EQ(select(shape, upside_down, 0.05, kMost).value(), upper);
  }
  EXPECT_EQ(selected(Box{{0.15, 0.15, 0.15}, {0.15, 0.15, 0.15}}), block({3, 3, 3}, {3, 3, 3}));
}

TEST(SelectPrism, TakesTheInsideOfConcavePolygonsAlone) {
  const auto voxels = selected(Prism{comb(3, 4), 0, 2}, 1);
  std::vector<VoxelIndex> expected = block({0, 0, 0}, {4, 0, 1});
  for (int tooth = 0; tooth < 3; ++tooth)
    std::ranges::copy(block({2 * tooth, 1, 0}, {2 * tooth, 4, 1}), std::back_inserter(expected));
  std::ranges::sort(expected);
  EXPECT_EQ(voxels, expected);
}

TEST(SelectLine, TakesEveryVoxelItTouchesEvenAtACorner) {
  EXPECT_EQ(selected(Line{{{0.5, 0.5, 0.5}, {3.5, 0.5, 0.5}}, 0}, 1), block({0, 0, 0}, {3, 0, 0}));
  EXPECT_EQ(selected(Line{{{0.5, 0.5, 0.5}, {1.5, 1.5, 1.5}}, 0}, 1), block({0, 0, 0}, {1, 1, 1}));
  EXPECT_EQ(selected(Line{{{0.5, 0.5, 0.5}, {1.5, 1.5, 0.5}}, 0}, 1), block({0, 0, 0}, {1, 1, 0}));
  EXPECT_EQ(selected(Line{{{0.5, 2, 0.5}, {1.5, 2, 0.5}}, 0}, 1), block({0, 1, 0}, {1, 2, 0})) << "along a face";
  EXPECT_EQ(selected(Line{{{0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}}, 0}, 1), block({0, 0, 0}, {0, 0, 0})) << "a point";
}

TEST(SelectLine, WithAThicknessTakesCentresWithinHalfOfIt) {
  const auto voxels = selected(Line{{{0.5, 0.5, 0.5}, {4.5, 0.5, 0.5}}, 2}, 1);
  std::vector<VoxelIndex> expected = block({0, 0, 0}, {4, 0, 0});
  for (const auto& more : {block({0, -1, 0}, {4, -1, 0}), block({0, 1, 0}, {4, 1, 0}), block({0, 0, -1}, {4, 0, -1}),
                           block({0, 0, 1}, {4, 0, 1}), block({-1, 0, 0}, {-1, 0, 0}), block({5, 0, 0}, {5, 0, 0})}) {
    expected.insert(expected.end(), more.begin(), more.end());
  }
  std::ranges::sort(expected);
  EXPECT_EQ(voxels, expected);
}

TEST(SelectArea, TakesBothLayersOfTheFaceItRunsAlong) {
  const Area wall{{{0.5, 0.5, 2}, {3.5, 0.5, 2}, {3.5, 2.5, 2}, {0.5, 2.5, 2}}, 0};
  EXPECT_EQ(selected(wall, 1), block({0, 0, 1}, {3, 2, 2}));
}

TEST(SelectArea, FollowsPointsThatAreNotQuiteInAPlane) {
  Area area{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.08}, {0, 1, 0}}, 0};
  const auto voxels = selected(area);
  EXPECT_TRUE(std::ranges::binary_search(voxels, VoxelIndex{19, 19, 1})) << "not flattened";
  area.points[2].z() = 0.4;
  EXPECT_EQ(refusal(area), Code::kBadShape);
}

TEST(SelectVoxels, AreTheMapsOwnWhereverTheFrameIs) {
  Transform elsewhere = kHere;
  elsewhere.translation() = Eigen::Vector3d(5, 5, 5);
  const VoxelList list{0.05, {{{0, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {2, 2, 2}}}};
  EXPECT_EQ(select(list, elsewhere, 0.05, 16)->size(), 15U);
}

TEST(SelectVoxels, AreRefusedInALatticeOfAnotherResolution) {
  VoxelList list{0.1, {{{0, 0, 0}, {1, 1, 1}}}};
  EXPECT_EQ(refusal(list, kHere, 0.05), Code::kBadResolution);
  EXPECT_EQ(refusal(list, kHere, 0.1 + 1e-6), Code::kBadResolution);
  EXPECT_EQ(select(list, kHere, 0.1, 8)->size(), 8U);
  list.resolution = 0;
  EXPECT_EQ(refusal(list), Code::kBadResolution);
  list.resolution = -0.05;
  EXPECT_EQ(refusal(list), Code::kBadResolution);
  list.resolution = std::nan("");
  EXPECT_EQ(refusal(list), Code::kNotFinite);
}

TEST(Select, CountsEachVoxelOnceAgainstTheLimit) {
  Line scribble{{}, 0.3};
  for (int i = 0; i < 200; ++i) scribble.points.emplace_back(0.02 * (i % 7), 0.03 * (i % 5), 0.04 * (i % 3));
  const auto count = static_cast<std::int64_t>(selected(scribble).size());
  EXPECT_EQ(select(scribble, kHere, 0.05, count)->size(), static_cast<std::size_t>(count));
  EXPECT_EQ(refusal(scribble, kHere, 0.05, count - 1), Code::kTooLarge);
  EXPECT_EQ(select(Box{{0, 0, 0}, {5, 5, 5}}, kHere, 0.05, kMost)->size(), 1'000'000U);
  EXPECT_EQ(refusal(Box{{0, 0, 0}, {5, 5, 5.01}}), Code::kTooLarge);
}

TEST(Select, RefusesEnormousShapesWithoutWalkingThem) {
  Transform tilted = kHere;
  tilted.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const double far = 1'000;
  EXPECT_EQ(refusal(Box{{-far, -far, -far}, {far, far, far}}), Code::kTooLarge);
  EXPECT_EQ(refusal(Box{{-far, 0, 0}, {far, 1e-4, 1e-4}}, tilted, 0.05, 1000), Code::kTooLarge);
  EXPECT_EQ(refusal(Line{{{-far, -far, -far}, {far, far, far}}, 4 * far}, kHere, 0.05, 1000), Code::kOutOfBounds);
  EXPECT_EQ(refusal(Line{{{0, 0, 0}, {1, 1, 1}}, far}), Code::kTooLarge);
  Line zigzag;
  for (int i = 0; i < 1000; ++i) zigzag.points.emplace_back(i % 2 == 0 ? -far : far, i, 0);
  EXPECT_EQ(refusal(zigzag), Code::kTooLarge);
  // Slivers as long as the map that hold no voxel: nothing to count, and yet work.
  Prism fan{{}, 0, 1};
  for (int i = 0; i < 500; ++i) fan.points.emplace_back(-far, i * 1e-8);
  for (int i = 499; i >= 0; --i) fan.points.emplace_back(far, i * 1e-8);
  EXPECT_EQ(refusal(fan, tilted), Code::kTooLarge);
}

TEST(Select, RefusesWhatReachesBeyondTheLattice) {
  const double edge = kMaxVoxel * 0.05;
  EXPECT_EQ(selected(Box{{edge - 0.05, 0, 0}, {edge, 0.05, 0.05}}),
            block({kMaxVoxel - 1, 0, 0}, {kMaxVoxel - 1, 0, 0}));
  EXPECT_EQ(refusal(Box{{edge - 0.05, 0, 0}, {edge + 0.01, 0.05, 0.05}}), Code::kOutOfBounds);
  EXPECT_EQ(refusal(Line{{{0, 0, 0}, {0, 0, -edge - 1}}, 0}), Code::kOutOfBounds);
  EXPECT_EQ(refusal(Box{{0, 0, 0}, {1e300, 1, 1}}), Code::kOutOfBounds);
  EXPECT_EQ(refusal(Box{{0, 0, 0}, {1, 1, 1}}, kHere, 1e-310), Code::kOutOfBounds);
  Transform away = kHere;
  away.translation().x() = 1e300;
  EXPECT_EQ(refusal(Box{{0, 0, 0}, {1, 1, 1}}, away), Code::kOutOfBounds);
  EXPECT_EQ(refusal(VoxelList{0.05, {{{0, 0, 0}, {0, 0, kMaxVoxel}}}}), Code::kOutOfBounds);
}

TEST(Select, RefusesWhatIsNoShape) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal(VoxelList{0.05, {}}), Code::kEmpty);
  EXPECT_EQ(refusal(VoxelList{0.05, {{{1, 0, 0}, {0, 0, 0}}}}), Code::kBadShape);
  EXPECT_EQ(refusal(Line{}), Code::kBadShape);
  EXPECT_EQ(refusal(Line{{{0, 0, 0}}, 0}), Code::kBadShape);
  EXPECT_EQ(refusal(Line{{{0, 0, 0}, {0, nan, 0}}, 0}), Code::kNotFinite);
  EXPECT_EQ(refusal(Line{{{0, 0, 0}, {0, 1, 0}}, -0.1}), Code::kBadShape);
  EXPECT_EQ(refusal(Line{{{0, 0, 0}, {0, 1, 0}}, infinity}), Code::kNotFinite);
  EXPECT_EQ(refusal(Line{std::vector<Eigen::Vector3d>(kMaxShapePoints + 1, Eigen::Vector3d::Zero()), 0}),
            Code::kTooLarge);
  EXPECT_EQ(refusal(Area{{{0, 0, 0}, {1, 0, 0}}, 0}), Code::kBadShape);
  EXPECT_EQ(refusal(Area{{{0, 0, 0}, {1, 2, 3}, {2, 4, 6}}, 0}), Code::kBadShape);
  EXPECT_EQ(refusal(Area{{{0, 0, 0}, {0.1, 0.3, 0.7}, {0.2, 0.6, 1.4}}, 0}), Code::kBadShape);
  EXPECT_EQ(refusal(Area{{{0, 0, 0}, {0, 1, 1}, {0, 1, 0}, {0, 0, 1}}, 0}), Code::kBadShape) << "crosses itself";
  EXPECT_EQ(refusal(Box{{0, 0, 0}, {1, -1, 1}}), Code::kBadShape);
  EXPECT_EQ(refusal(Box{{0, 0, 0}, {1, infinity, 1}}), Code::kNotFinite);
  EXPECT_EQ(refusal(OrientedBox{kHere, {1, -1, 1}}), Code::kBadShape);
  EXPECT_EQ(refusal(OrientedBox{kHere, {1, nan, 1}}), Code::kNotFinite);
  OrientedBox stretched{kHere, {1, 1, 1}};
  stretched.T_frame_box.linear() *= 2;
  EXPECT_EQ(refusal(stretched), Code::kBadTransform);
  stretched.T_frame_box.linear() = -Eigen::Matrix3d::Identity();
  EXPECT_EQ(refusal(stretched), Code::kBadTransform);
  EXPECT_EQ(refusal(Prism{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, 0, 1}), Code::kBadShape);
  EXPECT_EQ(refusal(Prism{{{0, 0}, {1, 0}, {1, 1}}, 1, 0}), Code::kBadShape);
  EXPECT_EQ(refusal(Prism{{{0, 0}, {1, 0}, {1, 1}}, 0, nan}), Code::kNotFinite);
  EXPECT_EQ(refusal(Prism{{{0, 0}, {1, 0}, {1, 1e-8}}, 0, 1}), Code::kEmpty);
  EXPECT_EQ(refusal(Box{{0, 0, 0}, {1, 1, 1}}, kHere, 0), Code::kBadResolution);
  EXPECT_EQ(refusal(Box{{0, 0, 0}, {1, 1, 1}}, kHere, nan), Code::kBadResolution);
  EXPECT_STREQ(name(Code::kBadShape), "BAD_SHAPE");
}

}  // namespace
}  // namespace concord
