#include "cli/selection_options.hpp"

#include <gtest/gtest.h>

namespace concord {
namespace {

constexpr double kResolution = 0.05;

SelectionOptions parse(std::vector<std::string> arguments, void (*add)(CLI::App&, SelectionOptions&)) {
  CLI::App app;
  SelectionOptions options;
  add(app, options);
  std::ranges::reverse(arguments);  // as CLI11 takes them
  app.parse(arguments);
  return options;
}

Result<Shape> shape(const std::vector<std::string>& arguments) {
  return shape_of(parse(arguments, add_shape_options), kResolution);
}

Result<Volume> volume(const std::vector<std::string>& arguments) {
  return volume_of(parse(arguments, add_volume_options));
}

TEST(SelectionOptions, EachShapeHasItsOption) {
  EXPECT_EQ(std::get<Line>(shape({"--line", "0 0 0 1 0 0", "--thickness", "0.2"}).value()).thickness, 0.2);
  EXPECT_EQ(std::get<Area>(shape({"--area", "0 0 0 1 0 0 1 1 0"}).value()).points.size(), 3U);
  EXPECT_EQ(std::get<Box>(shape({"--box", "1 1 1 0 0 0"}).value()).max, Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(std::get<OrientedBox>(shape({"--oriented-box", "0 0 0 0 0 0 1 1 2 3"}).value()).size,
            Eigen::Vector3d(1, 2, 3));
  const Prism prism = std::get<Prism>(volume({"--prism", "0 0 1 0 1 1", "--from", "-1", "--to", "2"}).value());
  EXPECT_EQ(prism.points.size(), 3U);
  EXPECT_EQ(prism.low, -1);
  EXPECT_EQ(prism.high, 2);
}

TEST(SelectionOptions, AVolumeIsNoLine) {
  EXPECT_THROW(parse({"--line", "0 0 0 1 0 0"}, add_volume_options), CLI::ParseError);
  EXPECT_THROW(parse({"--box", "0 0 0 1 1 1", "--prism", "0 0 1 0 1 1"}, add_volume_options), CLI::ParseError);
}

TEST(SelectionOptions, RefusesWhatIsNoShapeBeforeAnyoneIsAsked) {
  EXPECT_EQ(shape({}).error().code, Code::kBadRequest);
  EXPECT_EQ(volume({}).error().code, Code::kBadRequest);
  EXPECT_EQ(shape({"--line", "0 0 0"}).error().code, Code::kBadShape);
  EXPECT_EQ(shape({"--area", "0 0 0 1 1 0 1 0 0 0 1 0"}).error().code, Code::kBadShape) << "crosses itself";
  EXPECT_EQ(shape({"--box", "0 0 0 1e9 1 1"}).error().code, Code::kOutOfBounds);
  EXPECT_EQ(volume({"--prism", "0 0 1 0 1 1"}).error().code, Code::kBadRequest);
  EXPECT_EQ(volume({"--prism", "0 0 1 0 1 1", "--from", "2", "--to", "1"}).error().code, Code::kBadShape);
}

TEST(SelectionOptions, WhatTheShapeDoesNotHaveIsNotPassedOver) {
  EXPECT_EQ(shape({"--box", "0 0 0 1 1 1", "--thickness", "0.1"}).error().code, Code::kBadRequest);
  EXPECT_EQ(shape({"--box", "0 0 0 1 1 1", "--from", "0"}).error().code, Code::kBadRequest);
  EXPECT_EQ(shape({"--box", "0 0 0 1 1 1", "--frame-id", "f"}).error().code, Code::kBadRequest);
  EXPECT_EQ(shape({"--box", "0 0 0 1 1 1", "--frame", "a/b"}).error().code, Code::kBadName);
}

}  // namespace
}  // namespace concord
