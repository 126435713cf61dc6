#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <set>

#include "mapper/map_budget.hpp"
#include "mapper/room_mapper.hpp"
#include "mapper/triangle_cells.hpp"

namespace concord::hmd {
namespace {

MeshLook look_at(std::vector<MeshPart> parts, const Eigen::Vector3d& sensor = {0.025, 0.025, 1.5}) {
  MeshLook look;
  look.T_own_sensor.translation() = sensor;
  look.parts = std::move(parts);
  return look;
}
MeshPart quad(std::uint32_t number, float half, float z) {
  return {number, {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}}, {{0, 1, 2}, {0, 2, 3}}};
}

RC_GTEST_PROP(TriangleCells, AreThoseThatMeetTheTriangleAndNoOthers, ()) {
  const auto corner = [] {
    const auto c = [] { return *rc::gen::inRange(-400, 400) / 100.0 + 0.003; };
    return Eigen::Vector3d(c(), c(), c());
  };
  const TriangleCells::Corners corners{corner(), corner(), corner()};
  std::vector<VoxelIndex> cells;
  std::size_t budget = 100'000;
  RC_ASSERT(TriangleCells::append(corners, budget, cells));
  std::set<VoxelIndex> found(cells.begin(), cells.end());
  if ((corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() < 1e-9) {
    RC_ASSERT(found.empty());  // a line
    return;
  }
  TriangleCells::Corners nudged = corners;
  for (auto& c : nudged) c.array() += 1e-6;
  for (int x = -5; x <= 5; ++x) {
    for (int y = -5; y <= 5; ++y) {
      for (int z = -5; z <= 5; ++z) RC_ASSERT(found.contains({x, y, z}) == meets(nudged, {x, y, z}));
    }
  }
}

TEST(RoomMapper, AVoxelExistsAfterTwoLooksAndGoesWhenItsMeshIsGone) {
  RoomMapper mapper(0.05);
  ASSERT_TRUE(mapper.take(look_at({quad(1, 0.5F, 0.01F)}), 0));
  EXPECT_EQ(mapper.occupied(), 0) << "55 %";
  ASSERT_TRUE(mapper.take(look_at({}), 1));
  const std::int64_t there = mapper.occupied();
  EXPECT_GE(there, 20 * 20) << "60 %";
  ASSERT_TRUE(mapper.take(look_at({}), 2));
  ASSERT_TRUE(mapper.take(look_at({{1, {}, {}}}), 3));
  EXPECT_EQ(mapper.occupied(), there) << "65 - 1 %";
  std::int64_t looks = 0;
  while (mapper.occupied() > 0) ASSERT_TRUE(mapper.take(look_at({}), 4 + looks++));
  EXPECT_EQ(looks, 5) << "64 to 59 %";
}

TEST(RoomMapper, ASequenceThatBeginsAnewIsTheWholeRoom) {
  RoomMapper mapper(0.05);
  const auto wall = quad(0, 0.5F, 0.01F), chair = quad(1, 0.2F, 0.51F);
  EXPECT_EQ(mapper.take(look_at({wall}), 1).error().code, concord::Code::kBadFrame) << "a part of it, may be";
  for (int look = 0; look < 10; ++look) ASSERT_TRUE(mapper.take(look_at({wall, chair}), look));
  const std::int64_t both = mapper.occupied();
  mapper.end_sequence();
  EXPECT_FALSE(mapper.take(look_at({wall}), 7));
  ASSERT_TRUE(mapper.take(look_at({wall}), 0));
  EXPECT_EQ(mapper.occupied(), both) << "what they made stays at first";
  for (int look = 1; look < 60; ++look) ASSERT_TRUE(mapper.take(look_at({}), look));
  RoomMapper alone(0.05);
  for (int look = 0; look < 10; ++look) ASSERT_TRUE(alone.take(look_at({wall}), look));
  EXPECT_EQ(mapper.occupied(), alone.occupied()) << "the chair was carried away meanwhile";
}

TEST(RoomMapper, WhatALookCostsIsBoundedHoweverOftenATriangleIsRepeated) {
  MeshPart same = quad(1, 1.0F, 0.01F);
  for (int i = 0; i < 400; ++i) same.triangles.push_back({0, 1, 2});
  std::vector<MeshPart> parts;
  for (std::uint32_t number = 0; number < 1000; ++number) parts.push_back(same), parts.back().number = number;
  RoomMapper mapper(0.05);
  const auto taken = mapper.take(look_at(std::move(parts)), 0);
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code, concord::Code::kTooLarge);
  std::size_t budget = 1000;
  std::vector<VoxelIndex> cells;
  EXPECT_FALSE(TriangleCells::append({Eigen::Vector3d(0, 0, 0.5), {90, 0, 0.5}, {0, 90, 0.5}}, budget, cells));
  EXPECT_LE(cells.size(), 1000U);
  EXPECT_EQ(budget, 0U) << "the next triangle has none left";
}

TEST(RoomMapper, TrianglesThatAreLinesMeetNothingAndCostNothing) {
  MeshPart lines = quad(1, 1.0F, 0.01F);
  lines.vertices.insert(lines.vertices.end(), {{-4, -4, -1}, {0, 0, 1}, {4, 4, 3}});
  RoomMapper with(0.05), without(0.05);
  ASSERT_TRUE(without.take(look_at({lines}), 0));
  for (int i = 0; i < 400; ++i) lines.triangles.insert(lines.triangles.end(), {{4, 5, 6}, {4, 6, 6}, {5, 5, 5}});
  ASSERT_TRUE(with.take(look_at({lines}), 0));
  EXPECT_TRUE(with.map() == without.map());
  EXPECT_EQ(with.bytes(), without.bytes());
  EXPECT_GT(with.bytes(), RoomMapper(0.05).bytes());
}

TEST(MapBudget, WhatNobodySpeaksForGoesFirstAndNothingElseGoes) {
  const MapLimits limits{4, 2, 100, 50};
  using Names = std::vector<std::string>;
  std::vector<HeldMap> held{
      {"a", "ana", 20, 4, true}, {"b", "bert", 40, 2, false}, {"c", "carl", 30, 1, false}, {"d", "dora", 0, 3, true}};
  EXPECT_EQ(room_for_look(held, "ana", limits), Names{});
  EXPECT_EQ(room_for_agent(held, "ana", limits), Names{"c"}) << "the one used longest ago";
  held[0].bytes = 70;
  EXPECT_EQ(room_for_look(held, "dora", limits), (Names{"c", "b"})) << "until it fits";
  EXPECT_EQ(room_for_look(held, "ana", limits), std::nullopt) << "others' maps are no room for who has used up a share";
  held[1].spoken_for = held[2].spoken_for = true;
  EXPECT_EQ(room_for_look(held, "dora", limits), std::nullopt);
  EXPECT_EQ(room_for_agent(held, "dora", limits), std::nullopt);
  held[3] = {"d", "bert", 0, 3, false};
  EXPECT_EQ(room_for_agent(held, "bert", limits), Names{"d"}) << "of their own two";
}

TEST(RoomMapper, ProbabilityEndsAtAHundredPercent) {
  RoomMapper mapper(0.05);
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(mapper.take(look_at({quad(1, 0.2F, 0.01F)}), i));
  ASSERT_TRUE(mapper.take(look_at({{1, {}, {}}}), 30));
  std::int64_t looks = 1;
  for (; mapper.occupied() > 0; ++looks) ASSERT_TRUE(mapper.take(look_at({}), 30 + looks));
  EXPECT_EQ(looks, 41) << "100 to 59 %";
}

TEST(RoomMapper, RaysFreeWhatIsBeforeTheHitAndNeverTheHitNorWhatIsBehind) {
  RoomMapper mapper(0.05);
  // A table over a floor: below the table nothing is seen.
  const auto parts = std::vector<MeshPart>{quad(1, 0.5F, 0.01F), quad(2, 2.0F, -1.01F)};
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(mapper.take(look_at(parts), i));
  const BrickMap& map = mapper.map();
  const auto at = [&](double x, double y, double z) { return map.at(voxel_of({x, y, z}, 0.05)); };
  for (double z = 0.08; z < 1.5; z += 0.05)
    EXPECT_EQ(at(0.03, 0.03, z), kFree) << "straight down, along an axis: " << z;
  EXPECT_TRUE(is_occupied(at(0.03, 0.03, 0.01)));
  EXPECT_EQ(at(0.03, 0.03, -0.5), kUnknown);
  EXPECT_TRUE(is_occupied(at(1.8, 0.03, -1.01)));
  EXPECT_EQ(at(1.8, 0.03, -0.9), kFree);
}

TEST(RoomMapper, WhatIsBeyondReachIsNotJudged) {
  RoomMapper mapper(0.05);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(mapper.take(look_at({quad(1, 0.2F, 0.01F)}), i));
  const std::int64_t there = mapper.occupied();
  ASSERT_TRUE(mapper.take(look_at({{1, {}, {}}}, {30, 0, 1.5}), 3));
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(mapper.take(look_at({}, {30, 0, 1.5}), 4 + i));
  EXPECT_EQ(mapper.occupied(), there);
}

TEST(RoomMapper, WhatIsRefusedChangesNothing) {
  RoomMapper mapper(0.05);
  ASSERT_TRUE(mapper.take(look_at({quad(1, 0.5F, 0.01F)}), 0));
  EXPECT_EQ(mapper.take(look_at({}), 0).error().code, Code::kStale);
  EXPECT_EQ(mapper.take(look_at({quad(2, 900.0F, 0)}), 6).error().code, Code::kTooLarge);
  RoomMapper fine(0.005);
  EXPECT_EQ(fine.take(look_at({quad(2, 900.0F, 0)}), 0).error().code, Code::kOutOfBounds);
  ASSERT_TRUE(mapper.take(look_at({}), 6)) << "the sequence did not go on";
  EXPECT_GE(mapper.occupied(), 400);
}

}  // namespace
}  // namespace concord::hmd
