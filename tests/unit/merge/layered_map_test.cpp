#include "merge/layered_map.hpp"

#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace concord {
namespace {

constexpr double kResolution = 0.1;

Brick random_brick(std::mt19937& random) {
  DenseBrick dense;
  for (LogOdds& l : dense) {
    const auto roll = random() % 10;
    l = roll < 5 ? kUnknown : roll < 8 ? kFree : roll < 9 ? kOccupied : static_cast<LogOdds>(random() % 4000 - 2000);
  }
  return Brick::from_dense(dense);
}

BrickIndex random_index(std::mt19937& random) {
  const auto c = [&] { return static_cast<std::int32_t>(random() % 5) - 2; };
  return {c(), c(), c()};
}

Transform random_transform(std::mt19937& random) {
  const auto uniform = [&](double width) { return (static_cast<double>(random() % 2001) / 1000.0 - 1.0) * width; };
  Transform T = Transform::Identity();
  T.linear() = (Eigen::AngleAxisd(uniform(3.1), Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(uniform(0.2), Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  T.translation() = Eigen::Vector3d(uniform(2), uniform(2), uniform(0.5));
  return T;
}

EditRequest random_edit(std::mt19937& random, int number) {
  const auto c = [&] { return static_cast<std::int32_t>(random() % 40) - 20; };
  EditRequest edit;
  edit.id = "edit" + std::to_string(number);
  edit.op = random() % 2 == 0 ? EditRequest::Op::kAdd : EditRequest::Op::kDelete;
  for (int i = 0; i < 20; ++i) edit.voxels.push_back({c(), c(), c()});
  return edit;
}

/// What the map must be: the present layers composed from nothing.
MergedMap composed(const LayeredMap& layered, Policy policy) {
  std::vector<Layer> layers;
  for (const auto& [id, layer] : layered.layers()) {
    if (layer.T_map_agent) layers.push_back({&layer.map, *layer.T_map_agent, layer.weight});
  }
  return compose(layers, layered.edits().pins(), policy, kResolution);
}

void do_anything(LayeredMap& layered, std::mt19937& random, int number) {
  const std::string agent = "agent" + std::to_string(random() % 3);
  const bool there = layered.find(agent) != nullptr;
  const auto roll = random() % 12;
  if (!there || roll == 0) return layered.begin_layer(agent, "frame" + std::to_string(number), 1 + number % 7);
  if (roll == 1) return layered.remove_layer(agent);
  if (roll <= 3) return layered.place(agent, random_transform(random));
  if (roll == 4) return layered.apply(random_edit(random, number));
  if (roll == 5) return layered.set_brick(agent, random_index(random), Brick{});
  layered.set_brick(agent, random_index(random), random_brick(random));
}

RC_GTEST_PROP(LayeredMap, EqualsAFreshMergeAfterAnySequence, (std::uint32_t seed)) {
  std::mt19937 random(seed);
  const Policy policy = seed % 2 == 0 ? Policy::kMean : Policy::kTable;
  LayeredMap layered(kResolution, policy);
  for (int step = 0; step < 60; ++step) {
    do_anything(layered, random, step);
    if (random() % 4 == 0) layered.refold();
  }
  layered.refold();
  const MergedMap fresh = composed(layered, policy);
  RC_ASSERT(layered.map() == fresh.values);
  RC_ASSERT(layered.conflicts() == fresh.conflicts);
}

TEST(LayeredMap, TellsExactlyWhatChanged) {
  std::mt19937 random(1);
  LayeredMap layered(kResolution, Policy::kMean);
  layered.begin_layer("a", "f", 1);
  layered.place("a", Transform::Identity());
  layered.set_brick("a", {0, 0, 0}, random_brick(random));
  EXPECT_EQ(layered.refold().map, std::vector<BrickIndex>({{0, 0, 0}}));
  EXPECT_TRUE(layered.refold().map.empty());
  layered.set_brick("a", {0, 0, 0}, *layered.find("a")->map.find(BrickIndex{0, 0, 0}));
  EXPECT_TRUE(layered.refold().map.empty()) << "a brick sent again changes nothing";
}

TEST(LayeredMap, KeepsWhatIsNotAlignedOutside) {
  std::mt19937 random(2);
  LayeredMap layered(kResolution, Policy::kMean);
  layered.begin_layer("a", "f", 1);
  layered.set_brick("a", {0, 0, 0}, random_brick(random));
  layered.refold();
  EXPECT_TRUE(layered.map().empty());
  layered.place("a", Transform::Identity());
  layered.refold();
  EXPECT_FALSE(layered.map().empty());
  layered.begin_layer("a", "g", 1);
  layered.refold();
  EXPECT_TRUE(layered.map().empty()) << "a new frame leaves no ghost of the one before";
}

TEST(LayeredMap, CountsVoxels) {
  LayeredMap layered(kResolution, Policy::kMean);
  layered.begin_layer("a", "f", 1);
  VoxelMask mask{};
  mask[0] = 0b111;
  layered.set_brick("a", {0, 0, 0}, Brick::uniform(mask, kOccupied));
  mask[0] = 0b11;
  layered.set_brick("a", {1, 0, 0}, Brick::uniform(mask, kFree));
  EXPECT_EQ(layered.find("a")->known, 5);
  EXPECT_EQ(layered.find("a")->occupied, 3);
  layered.set_brick("a", {0, 0, 0}, Brick{});
  EXPECT_EQ(layered.find("a")->known, 2);
  EXPECT_EQ(layered.find("a")->occupied, 0);
}

TEST(EditLayer, LatestEditWinsInItsVoxels) {
  EditLayer edits;
  BrickSet touched;
  edits.apply({"one", "eva", EditRequest::Op::kAdd, {{0, 0, 0}, {0, 0, 1}}, 0}, touched);
  edits.apply({"two", "eva", EditRequest::Op::kDelete, {{0, 0, 1}}, 0}, touched);
  EXPECT_EQ(edits.pins().at({0, 0, 0}), PinMap::Pin::kAdded);
  EXPECT_EQ(edits.pins().at({0, 0, 1}), PinMap::Pin::kDeleted);
  EXPECT_EQ(edits.find("two")->revision, 2);
  EXPECT_EQ(edits.find("three"), nullptr);
  EXPECT_TRUE(touched.contains(BrickIndex{0, 0, 0}));
}

}  // namespace
}  // namespace concord
