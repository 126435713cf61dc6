#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "random_shapes.hpp"
#include "shape_oracle.hpp"

namespace concord {
namespace {

namespace oracle = shape_oracle;

constexpr double kResolution = 0.05;
constexpr long double kEither = 1e-5L;

struct AnyPrism {
  Prism prism;
  Transform T_map_frame;
  oracle::Solid solid;
};

AnyPrism any_prism() {
  const auto points = any_polygon(0.35);
  const double a = any_number(-0.3, 0.3), b = a + any_number(0.001, 0.3);
  const Transform T = any_transform(0.15);
  std::vector<oracle::FlatPoint> corners;
  for (const auto& p : points) corners.push_back(p.cast<long double>());
  return {{points, a, b}, T, {T.cast<long double>(), corners, a, b}};
}

RC_GTEST_PROP(Footprint, TakesTheCellsThatTheVolumeTouchesInTheBand, ()) {
  const AnyPrism any = any_prism();
  const double zmin = any_number(-0.3, 0.2), zmax = zmin + any_number(0.01, 0.3);
  const auto cells = footprint(any.prism, any.T_map_frame, kResolution, zmin, zmax, 100'000);
  RC_ASSERT(cells.has_value());
  RC_ASSERT(std::ranges::is_sorted(*cells));
  const auto met = [&](VoxelIndex v, long double grown) {
    oracle::Cell cell = oracle::cell_of(v, kResolution, grown);
    cell.centre.z() = (static_cast<long double>(zmin) + zmax) / 2;
    cell.half.z() = (static_cast<long double>(zmax) - zmin) * (0.5L + grown);
    return oracle::meets(any.solid, cell);
  };
  for (std::int32_t x = -20; x < 20; ++x)
    for (std::int32_t y = -20; y < 20; ++y) {
      const VoxelIndex v{x, y, 0};
      const bool selected = std::ranges::binary_search(*cells, v);
      if (selected && !met(v, kEither)) RC_FAIL("blocked without need");
      if (!selected && met(v, 0)) RC_FAIL("left open");
    }
  for (const VoxelIndex& v : *cells) RC_ASSERT(v.z == 0 && std::abs(v.x) < 20 && std::abs(v.y) < 20);
}

RC_GTEST_PROP(Contains, IsTrueInTheVolumeAlone, ()) {
  const AnyPrism any = any_prism();
  const Eigen::Vector3d p = any_point(0.4);
  const oracle::Cell around{p.cast<long double>(), oracle::Point::Constant(kEither)};
  if (!oracle::meets(any.solid, around)) {
    RC_ASSERT(!contains(any.prism, any.T_map_frame, p));
    return;
  }
  // Deep inside: a cell around the point that no side of the volume cuts.
  const Eigen::Vector3d q = any.T_map_frame.inverse() * p;
  const bool deep = q.z() > any.prism.low && q.z() < any.prism.high && encloses(any.prism.points, q.head<2>(), 0);
  RC_CLASSIFY(deep, "inside");
  if (deep) RC_ASSERT(contains(any.prism, any.T_map_frame, p));
}

TEST(Contains, TakesTheBoundaryOfEveryKindOfVolume) {
  Transform T = Transform::Identity();
  T.translation() = Eigen::Vector3d(10, 0, 0);
  const Volume box = Box{{0, 0, 0}, {1, 2, 3}};
  OrientedBox around{Transform::Identity(), {1, 2, 3}};
  around.T_frame_box.translation() = Eigen::Vector3d(0.5, 1, 1.5);
  const Volume prism = Prism{{{0, 0}, {1, 0}, {1, 2}, {0, 2}}, 0, 3};
  for (const Volume& volume : {box, Volume(around), prism}) {
    ASSERT_TRUE(check(volume).has_value());
    EXPECT_TRUE(contains(volume, T, {10.5, 1, 1}));
    EXPECT_TRUE(contains(volume, T, {10, 0, 0}));
    EXPECT_TRUE(contains(volume, T, {11, 2, 3}));
    EXPECT_FALSE(contains(volume, T, {11.00001, 1, 1}));
    EXPECT_FALSE(contains(volume, T, {10.5, 1, -0.00001}));
    EXPECT_FALSE(contains(volume, T, {0.5, 1, 1}));
    EXPECT_FALSE(contains(volume, T, {10.5, std::nan(""), 1}));
  }
}

TEST(Footprint, TakesCellsThatOnlyTouch) {
  const auto cells = footprint(Box{{0.1, 0.1, 0}, {0.2, 0.15, 1}}, Transform::Identity(), 0.05, 0.1, 0.5, 100);
  ASSERT_TRUE(cells.has_value());
  EXPECT_EQ(cells->size(), 4U * 3U) << "2 x 1 cells and a ring around them";
  EXPECT_EQ(cells->front(), (VoxelIndex{1, 1, 0}));
}

TEST(Footprint, IsEmptyAboveAndBelowTheBand) {
  const Box box{{0, 0, 0}, {1, 1, 1}};
  for (const double zmin : {-1.0, 1.1}) {
    const auto cells = footprint(box, Transform::Identity(), 0.05, zmin, zmin + 0.5, 10'000);
    ASSERT_TRUE(cells.has_value());
    EXPECT_TRUE(cells->empty());
  }
}

TEST(Footprint, RefusesWhatCannotBeDrawn) {
  const Box box{{0, 0, 0}, {1, 1, 1}};
  const auto refusal = [](const auto& result) { return result ? Code::kIo : result.error().code; };
  const Transform I = Transform::Identity();
  EXPECT_EQ(refusal(footprint(box, I, 0.05, 1, 1, 10'000)), Code::kBadRequest);
  EXPECT_EQ(refusal(footprint(box, I, 0.05, std::nan(""), 1, 10'000)), Code::kBadRequest);
  EXPECT_EQ(refusal(footprint(box, I, 0.05, 0, 1e300, 10'000)), Code::kBadRequest);
  EXPECT_EQ(refusal(footprint(box, I, 0.05, 0, 1, 483)), Code::kTooLarge);
  EXPECT_EQ(footprint(box, I, 0.05, 0, 1, 484)->size(), 484U);
  EXPECT_EQ(refusal(footprint(Box{{0, 0, 0}, {1e6, 1, 1}}, I, 0.05, 0, 1, 100'000'000)), Code::kOutOfBounds);
  EXPECT_EQ(refusal(footprint(Prism{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, 0, 1}, I, 0.05, 0, 1, 100)), Code::kBadShape);
}

}  // namespace
}  // namespace concord
