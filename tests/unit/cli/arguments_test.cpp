#include "cli/arguments.hpp"

#include <gtest/gtest.h>

namespace concord {
namespace {

TEST(Arguments, NumbersAreSeparatedBySpacesOrCommas) {
  EXPECT_EQ(parse_numbers(" 1 -2.5,3e2 ", 3).value(), (std::vector<double>{1, -2.5, 300}));
}

TEST(Arguments, RefusesWhatIsNotThatManyFiniteNumbers) {
  EXPECT_EQ(parse_numbers("1 2", 3).error().code, Code::kMalformed);
  EXPECT_EQ(parse_numbers("1 2 3 4", 3).error().code, Code::kMalformed);
  EXPECT_EQ(parse_numbers("1 2 x", 3).error().code, Code::kMalformed);
  EXPECT_EQ(parse_numbers("1 2 3x", 3).error().code, Code::kMalformed);
  EXPECT_EQ(parse_numbers("", 1).error().code, Code::kMalformed);
  EXPECT_EQ(parse_numbers("1 nan 3", 3).error().code, Code::kNotFinite);
  EXPECT_EQ(parse_numbers("1 2 1e999", 3).error().code, Code::kNotFinite);
}

TEST(Arguments, ATransformIsPositionThenQuaternionXyzw) {
  const Transform T = parse_transform("1 2 3 0 0 0.70710678 0.70710678").value();
  EXPECT_TRUE((T * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(1, 3, 3), 1e-6));
  EXPECT_EQ(parse_transform("0 0 0 0 0 0 0").error().code, Code::kBadTransform);
  EXPECT_EQ(parse_transform("0 0 0 0 0 0").error().code, Code::kMalformed);
}

TEST(Arguments, ABoxOnVoxelFacesHoldsExactlyThoseBetween) {
  const VoxelBox box = parse_box("0 0.05 1.15 0.1 0.2 1.3", 0.05).value();
  EXPECT_EQ(box.min, (VoxelIndex{0, 1, 23}));
  EXPECT_EQ(box.max, (VoxelIndex{1, 3, 25}));
}

TEST(Arguments, ABoxTakesEveryVoxelItReachesInto) {
  const VoxelBox box = parse_box("0.01 -0.01 0.04 0.06 0.01 0.051", 0.05).value();
  EXPECT_EQ(box.min, (VoxelIndex{0, -1, 0}));
  EXPECT_EQ(box.max, (VoxelIndex{1, 0, 1}));
}

TEST(Arguments, APaneWithoutThicknessIsOneLayer) {
  const VoxelBox on_face = parse_box("1 0 0 1 0.1 0.1", 0.05).value();
  EXPECT_EQ(on_face.min.x, 20);
  EXPECT_EQ(on_face.max.x, 20);
  const VoxelBox inside = parse_box("1.02 0 0 1.02 0.1 0.1", 0.05).value();
  EXPECT_EQ(inside.min.x, 20);
  EXPECT_EQ(inside.max.x, 20);
}

TEST(Arguments, CornersComeInAnyOrder) {
  EXPECT_EQ(parse_box("0.1 0.2 0.3 0 0 0", 0.05).value(), parse_box("0 0 0 0.1 0.2 0.3", 0.05).value());
}

TEST(Arguments, RefusesABoxBeyondTheLattice) {
  EXPECT_EQ(parse_box("0 0 0 1e9 1 1", 0.05).error().code, Code::kOutOfBounds);
  EXPECT_EQ(parse_box("0 0 0 1e308 1 1", 0.005).error().code, Code::kOutOfBounds);
}

}  // namespace
}  // namespace concord
