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

TEST(Arguments, ABoxIsTwoCornersInAnyOrder) {
  const Box box = parse_box("0.1 0.2 0.3 0 0.5 0").value();
  EXPECT_EQ(box.min, Eigen::Vector3d(0, 0.2, 0));
  EXPECT_EQ(box.max, Eigen::Vector3d(0.1, 0.5, 0.3));
  EXPECT_EQ(parse_box("0 0 0 1 1").error().code, Code::kMalformed);
}

TEST(Arguments, PointsAreThreeNumbersEach) {
  EXPECT_EQ(parse_points("1 2 3, 4 5 6").value().at(1), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(parse_points("1 2 3 4").error().code, Code::kMalformed);
  EXPECT_EQ(parse_points("").error().code, Code::kMalformed);
  EXPECT_EQ(parse_points("1 2 nan").error().code, Code::kNotFinite);
}

TEST(Arguments, PointsFromAboveAreTwoNumbersEach) {
  EXPECT_EQ(parse_points_2d("1 2, 3 4").value().at(1), Eigen::Vector2d(3, 4));
  EXPECT_EQ(parse_points_2d("1 2 3").error().code, Code::kMalformed);
  EXPECT_EQ(parse_points_2d("").error().code, Code::kMalformed);
}

TEST(Arguments, AnOrientedBoxIsItsPoseAndItsEdges) {
  const OrientedBox box = parse_oriented_box("1 2 3 0 0 0.70710678 0.70710678 4 5 6").value();
  EXPECT_EQ(box.size, Eigen::Vector3d(4, 5, 6));
  EXPECT_TRUE((box.T_frame_box * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(1, 3, 3), 1e-6));
  EXPECT_EQ(parse_oriented_box("1 2 3 0 0 0 0 4 5 6").error().code, Code::kBadTransform);
  EXPECT_EQ(parse_oriented_box("1 2 3 0 0 0 1").error().code, Code::kMalformed);
}

}  // namespace
}  // namespace concord
