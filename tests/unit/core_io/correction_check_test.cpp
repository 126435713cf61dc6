#include "core/correction_check.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "archives.hpp"

namespace concord {
namespace {

using test::correction;
using test::edit_of;
using test::zone_of;
using What = decltype(Correction::what);

const Box kBox{{0, 0, 0}, {1, 1, 1}};

class CorrectionCheckTest : public ::testing::Test {
 protected:
  std::string take(const Correction& one) {
    const auto taken = check_.take(one);
    return taken ? "OK" : name(taken.error().code);
  }
  /// With the next revision and an id of its own.
  std::string take(What what) {
    ++revision_;
    return take(correction(revision_, "c" + std::to_string(revision_), std::move(what)));
  }

  CorrectionCheck check_;
  std::int64_t revision_ = 0;
};

RC_GTEST_PROP(CorrectionCheckProperty, WhatMayFollowIsTaken, ()) {
  CorrectionCheck check;
  for (const Correction& one : (*test::arbitrary_archive()).corrections) RC_ASSERT(check.take(one).has_value());
}

TEST_F(CorrectionCheckTest, RevisionsAscendFromOne) {
  EXPECT_EQ(take(correction(0, "a", Correction::Weight{"robot1", 2})), "STALE");
  EXPECT_EQ(take(correction(-5, "a", Correction::Weight{"robot1", 2})), "STALE");
  EXPECT_EQ(take(correction(3, "a", Correction::Weight{"robot1", 2})), "OK");
  EXPECT_EQ(take(correction(3, "b", Correction::Weight{"robot1", 2})), "STALE");
  EXPECT_EQ(take(Correction{INT64_MAX, "b", "ann", 0, 0, Correction::Weight{"robot1", 2}}), "OK");
}

TEST_F(CorrectionCheckTest, IdsAndAuthorsAreTextsAndIdsAreUnique) {
  Correction one = correction(1, "", Correction::Weight{"robot1", 2});
  EXPECT_EQ(take(one), "BAD_NAME");
  one.id = "a\n";
  EXPECT_EQ(take(one), "BAD_NAME");
  one.id = std::string(81, 'a');
  EXPECT_EQ(take(one), "BAD_NAME");
  one.id = std::string(80, 'a');
  one.author = std::string(81, 'a');
  EXPECT_EQ(take(one), "BAD_NAME");
  one.author = "";
  one.utime = -1;
  EXPECT_EQ(take(one), "BAD_REQUEST");
  one.utime = 0;
  EXPECT_EQ(take(one), "OK");
  one.revision = 2;
  EXPECT_EQ(take(one), "EXISTS");
}

TEST_F(CorrectionCheckTest, TextsAreUtf8AsOnTheWire) {
  EXPECT_EQ(take(correction(1, "a\xFF", Correction::Weight{"robot1", 2})), "BAD_NAME");
  Correction one = correction(1, "T\u00fcr", Correction::Weight{"robot1", 2});
  one.author = "eva\xC3";
  EXPECT_EQ(take(one), "BAD_NAME") << "cut short";
  one.author = "J\u00f6rg";
  EXPECT_EQ(take(one), "OK");
  revision_ = 1;
  EXPECT_EQ(take(zone_of(ZoneRequest::Op::kAdd, "dock \xFF", kBox)), "BAD_NAME");
  EXPECT_EQ(take(zone_of(ZoneRequest::Op::kAdd, "dock \xC0\xAF", kBox)), "BAD_NAME") << "an overlong slash";
  EXPECT_EQ(take(zone_of(ZoneRequest::Op::kAdd, "T\u00fcr 7", kBox)), "OK");
}

TEST_F(CorrectionCheckTest, AnEditPinsSortedVoxelsAsItsOpDoes) {
  using Op = EditRequest::Op;
  const std::vector<VoxelIndex> a{{0, 0, 0}, {0, 0, 1}};
  const std::vector<VoxelIndex> b{{0, 0, 1}, {0, 0, 2}};
  const std::vector<VoxelIndex> c{{5, 5, 5}};
  EXPECT_EQ(take(Correction::Edit{Op::kAdd, a, {}}), "OK");
  EXPECT_EQ(take(Correction::Edit{Op::kDelete, {}, a}), "OK");
  EXPECT_EQ(take(Correction::Edit{Op::kMove, c, a}), "OK");
  EXPECT_EQ(take(Correction::Edit{Op::kMove, c, {}}), "OK");
  EXPECT_EQ(take(Correction::Edit{Op::kAdd, {}, {}}), "EMPTY");
  EXPECT_EQ(take(Correction::Edit{Op::kAdd, a, c}), "BAD_REQUEST");
  EXPECT_EQ(take(Correction::Edit{Op::kDelete, a, c}), "BAD_REQUEST");
  EXPECT_EQ(take(Correction::Edit{Op::kMove, {}, a}), "BAD_REQUEST");
  EXPECT_EQ(take(Correction::Edit{Op::kMove, a, b}), "BAD_REQUEST") << "in both";
  EXPECT_EQ(take(edit_of({{1, 0, 0}, {0, 0, 0}})), "BAD_REQUEST");
  EXPECT_EQ(take(edit_of({{1, 0, 0}, {1, 0, 0}})), "BAD_REQUEST");
  EXPECT_EQ(take(edit_of({{kMaxVoxel, 0, 0}})), "OUT_OF_BOUNDS");
  EXPECT_EQ(take(edit_of({{INT32_MIN, 0, 0}, {INT32_MAX, 0, 0}})), "OUT_OF_BOUNDS");
  std::vector<VoxelIndex> many;
  for (int i = 0; i <= kMaxStoredEditVoxels; ++i) many.push_back({i / 1000, i % 1000, 0});
  EXPECT_EQ(take(edit_of(many)), "TOO_LARGE");
  many.pop_back();
  EXPECT_EQ(take(edit_of(many)), "OK");
}

TEST_F(CorrectionCheckTest, AllEditsTogetherAreBounded) {
  std::vector<VoxelIndex> many;
  for (int i = 0; i < kMaxStoredEditVoxels; ++i) many.push_back({i / 1000, i % 1000, 0});
  const Correction::Edit edit = edit_of(many);
  for (std::int64_t i = 0; i < kMaxPins / kMaxStoredEditVoxels; ++i) ASSERT_EQ(take(edit), "OK");
  EXPECT_EQ(take(edit_of({{0, 0, 0}})), "TOO_LARGE");
}

TEST_F(CorrectionCheckTest, EditsAreUndoneAndRedoneByTurns) {
  EXPECT_EQ(take(correction(1, "e", edit_of({{1, 2, 3}}))), "OK");
  revision_ = 1;
  EXPECT_EQ(take(Correction::Undo{"e", true}), "CONFLICT");
  EXPECT_EQ(take(Correction::Undo{"e", false}), "OK");
  EXPECT_EQ(take(Correction::Undo{"e", false}), "CONFLICT");
  EXPECT_EQ(take(Correction::Undo{"e", true}), "OK");
  EXPECT_EQ(take(Correction::Undo{"e", false}), "OK");
  EXPECT_EQ(take(Correction::Undo{"c2", false}), "NOT_FOUND") << "an undo is no edit";
  EXPECT_EQ(take(Correction::Undo{"f", false}), "NOT_FOUND");
}

TEST_F(CorrectionCheckTest, ZonesAreAddedChangedAndDeletedByTurns) {
  using Op = ZoneRequest::Op;
  EXPECT_EQ(take(zone_of(Op::kChange, "door", kBox)), "NOT_FOUND");
  EXPECT_EQ(take(zone_of(Op::kDelete, "door", kBox)), "NOT_FOUND");
  EXPECT_EQ(take(zone_of(Op::kAdd, "door", kBox)), "OK");
  EXPECT_EQ(take(zone_of(Op::kAdd, "door", kBox)), "EXISTS");
  EXPECT_EQ(take(zone_of(Op::kChange, "door", kBox)), "OK");
  EXPECT_EQ(take(zone_of(Op::kDelete, "door", Box{{1, 1, 1}, {0, 0, 0}})), "OK") << "its volume is not heeded";
  EXPECT_EQ(take(zone_of(Op::kAdd, "door", kBox)), "OK");
  EXPECT_EQ(take(zone_of(Op::kAdd, "a/b", kBox)), "BAD_NAME");
}

TEST_F(CorrectionCheckTest, ZonesAreBounded) {
  for (std::size_t i = 0; i < kMaxZones; ++i) {
    ASSERT_EQ(take(zone_of(ZoneRequest::Op::kAdd, "z" + std::to_string(i), kBox)), "OK");
  }
  EXPECT_EQ(take(zone_of(ZoneRequest::Op::kAdd, "one more", kBox)), "TOO_LARGE");
  EXPECT_EQ(take(zone_of(ZoneRequest::Op::kChange, "z7", kBox)), "OK");
  EXPECT_EQ(take(zone_of(ZoneRequest::Op::kDelete, "z7", kBox)), "OK");
  EXPECT_EQ(take(zone_of(ZoneRequest::Op::kAdd, "one more", kBox)), "OK");
}

TEST_F(CorrectionCheckTest, AZoneIsAVolumeInAFrame) {
  const auto with = [this](const Volume& volume) { return take(zone_of(ZoneRequest::Op::kAdd, "door", volume)); };
  EXPECT_EQ(with(Box{{0, 0, 0}, {NAN, 1, 1}}), "NOT_FINITE");
  EXPECT_EQ(with(Box{{2, 0, 0}, {1, 1, 1}}), "BAD_SHAPE");
  EXPECT_EQ(with(Prism{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, 0, 1}), "BAD_SHAPE") << "it crosses itself";
  Prism round{{}, 0, 1};
  for (int i = 0; i < 65; ++i) round.points.emplace_back(std::cos(i * 0.0966), std::sin(i * 0.0966));
  EXPECT_EQ(with(round), "TOO_LARGE");
  Correction::ZoneChange change = zone_of(ZoneRequest::Op::kAdd, "door", kBox);
  change.zone.T_map_zone.linear() *= 2;
  EXPECT_EQ(take(change), "BAD_TRANSFORM");
}

TEST_F(CorrectionCheckTest, APlacementIsARotationAndATranslation) {
  const auto with = [this](const auto& change) {
    Correction::Placement placement{"robot1", "f", 1, true, Transform::Identity()};
    change(placement);
    return take(placement);
  };
  EXPECT_EQ(with([](auto&) {}), "OK");
  EXPECT_EQ(with([](auto& p) { p.agent = "../x"; }), "BAD_NAME");
  EXPECT_EQ(with([](auto& p) { p.frame_id = ""; }), "BAD_NAME");
  EXPECT_EQ(with([](auto& p) { p.T_map_agent.linear()(0, 0) = NAN; }), "NOT_FINITE");
  EXPECT_EQ(with([](auto& p) { p.T_map_agent.translation().x() = INFINITY; }), "NOT_FINITE");
  EXPECT_EQ(with([](auto& p) { p.T_map_agent.linear()(0, 0) = -1; }), "BAD_TRANSFORM") << "a mirror";
  EXPECT_EQ(with([](auto& p) { p.T_map_agent.linear() *= 1e300; }), "BAD_TRANSFORM");
  EXPECT_EQ(with([](auto& p) { p.T_map_agent.translation().x() = 10'001; }), "BAD_TRANSFORM");
}

TEST_F(CorrectionCheckTest, WeightsAreOneToAThousand) {
  EXPECT_EQ(take(Correction::Weight{"robot1", 0}), "BAD_REQUEST");
  EXPECT_EQ(take(Correction::Weight{"robot1", 1001}), "BAD_REQUEST");
  EXPECT_EQ(take(Correction::Weight{"", 1}), "BAD_NAME");
  EXPECT_EQ(take(Correction::Weight{"robot1", 1000}), "OK");
}

TEST_F(CorrectionCheckTest, WhatIsRefusedIsNotTaken) {
  EXPECT_EQ(take(correction(5, "a", edit_of({}))), "EMPTY");
  EXPECT_EQ(take(correction(1, "a", edit_of({{1, 2, 3}}))), "OK") << "neither its revision nor its id was";
}

}  // namespace
}  // namespace concord
