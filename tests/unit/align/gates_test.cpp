#include "align/gates.hpp"

#include <gtest/gtest.h>

namespace concord {
namespace {

/// A room of which both maps show 60 % of 100 m2 of walls and 40 m2 of floor and ceiling, and nothing speaks against
/// it.
Support a_good_place() {
  Support s;
  const Verdicts walls{100.0, 60.0, 0.0, 0.0};
  const Verdicts floors{40.0, 24.0, 0.0, 0.0};
  s.source_upright = s.target_upright = walls;
  s.source_level = s.target_level = floors;
  s.matched_facing = 60.0 * Eigen::Matrix2d::Identity();
  return s;
}

TEST(Gates, TakeWhatNothingSpeaksAgainst) {
  EXPECT_EQ(check_gates(a_good_place(), Origin::kGuess).reason, AlignReason::kAccepted);
  EXPECT_EQ(check_gates(a_good_place(), Origin::kAnywhere).reason, AlignReason::kAccepted);
}

TEST(Gates, AskMoreOfAPlaceThatNobodyGuessed) {
  Support s = a_good_place();
  for (Verdicts* v : {&s.source_upright, &s.target_upright}) v->matched = 35.0;
  for (Verdicts* v : {&s.source_level, &s.target_level}) v->matched = 14.0;
  EXPECT_EQ(check_gates(s, Origin::kGuess).reason, AlignReason::kAccepted);
  EXPECT_EQ(check_gates(s, Origin::kAnywhere).reason, AlignReason::kLowOverlap);
}

TEST(Gates, AllowABuildingTheDriftThatARoomIsNotAllowed) {
  Support room = a_good_place();
  room.source_upright.displaced = 3.0;
  EXPECT_EQ(check_gates(room, Origin::kGuess).reason, AlignReason::kAccepted) << "2.4 %; 120 m2 of walls allow 3.2 %";
  room.source_upright.matched = room.target_upright.matched = 45.0;  // 3.2 % now, and 90 m2 allow 2.5 %
  EXPECT_EQ(check_gates(room, Origin::kGuess).reason, AlignReason::kDiverged);
  Support building = a_good_place();
  building.source_upright = building.target_upright = {400.0, 200.0, 16.0, 0.0};  // 7 %
  building.matched_facing = 200.0 * Eigen::Matrix2d::Identity();
  EXPECT_EQ(check_gates(building, Origin::kGuess).reason, AlignReason::kAccepted);
}

TEST(Gates, HearFloorsOnlyWhereThereAreAny) {
  Support s = a_good_place();
  s.source_level.displaced = 12.0;  // 20 % of the floors, 7 % of everything
  EXPECT_EQ(check_gates(s, Origin::kGuess).reason, AlignReason::kDiverged);
  s.source_level = s.target_level = {4.0, 3.0, 0.8, 0.0};  // 21 % of what is no floor but edges
  s.source_upright.matched = s.target_upright.matched = 60.0;
  EXPECT_EQ(check_gates(s, Origin::kGuess).reason, AlignReason::kAccepted);
}

TEST(Gates, WantSomethingThatHoldsTheHeight) {
  Support s = a_good_place();
  s.source_level = s.target_level = {40.0, 0.4, 0.0, 0.0};
  EXPECT_EQ(check_gates(s, Origin::kGuess).reason, AlignReason::kDegenerate);
}

TEST(Gates, LetOneDirectionSpeak) {
  Support s = a_good_place();
  s.source_upright.displaced = 2.0;
  s.matched_facing = Eigen::Vector2d(55.0, 5.0).asDiagonal();
  EXPECT_EQ(check_gates(s, Origin::kGuess).reason, AlignReason::kAccepted);
  s.against_facing = Eigen::Vector2d(0.0, 3.0).asDiagonal();
  EXPECT_EQ(check_gates(s, Origin::kGuess).reason, AlignReason::kDiverged);
}

TEST(Gates, WantWallsAndNothingAgainstThemWhereThingsWereMoved) {
  Support rest = a_good_place();
  rest.source_upright.displaced = 0.1;  // of 120 m2
  EXPECT_TRUE(agrees_but_for_moved_things(rest));
  rest.source_upright.displaced = 0.3;
  EXPECT_FALSE(agrees_but_for_moved_things(rest));
  rest = a_good_place();
  rest.source_upright = rest.target_upright = {30.0, 19.0, 0.0, 0.0};
  EXPECT_FALSE(agrees_but_for_moved_things(rest)) << "half a small room laid over the other half";
}

/// In a row of offices each has its chairs elsewhere.
TEST(Gates, CallMorePlacesRivalsWhereNobodyGuessed) {
  const auto with_against = [](double share) {
    Support s = a_good_place();
    for (Verdicts* v : {&s.source_upright, &s.target_upright}) {
      v->matched = 45.0;  // 90 m2 of both: a room
      v->displaced = 45.0 * share / (1.0 - share);
    }
    return s;
  };
  const Support accepted = with_against(0.015);
  EXPECT_TRUE(is_rival(with_against(0.049), accepted, Origin::kGuess));
  EXPECT_FALSE(is_rival(with_against(0.051), accepted, Origin::kGuess));
  EXPECT_TRUE(is_rival(with_against(0.074), accepted, Origin::kAnywhere)) << "five times as much as the answer has";
  EXPECT_FALSE(is_rival(with_against(0.076), accepted, Origin::kAnywhere));
  EXPECT_TRUE(is_rival(with_against(0.099), with_against(0.025), Origin::kAnywhere));
  EXPECT_FALSE(is_rival(with_against(0.101), with_against(0.025), Origin::kAnywhere)) << "a tenth is another office";
  EXPECT_TRUE(is_rival(with_against(0.049), with_against(0.0), Origin::kAnywhere)) << "no less than with a guess";
  EXPECT_FALSE(is_rival(with_against(0.051), with_against(0.0), Origin::kAnywhere));
  Support apart = with_against(0.0);
  for (Verdicts* v : {&apart.source_upright, &apart.target_upright}) v->all = 200.0;
  EXPECT_FALSE(is_rival(apart, accepted, Origin::kAnywhere)) << "hardly anything lies on anything";
}

/// A mirror image that lies better tells rooms apart, up to the size of a hall.
TEST(Gates, AskForAMirrorImageUpToTheSizeOfAHall) {
  const auto of_walls = [](double matched) {
    Support s = a_good_place();
    s.source_upright = s.target_upright = {matched, 0.5 * matched, 0.01 * matched, 0.0};
    return s;
  };
  EXPECT_TRUE(may_be_mirrored(of_walls(100.0)));
  EXPECT_TRUE(may_be_mirrored(of_walls(600.0))) << "a floor of offices";
  EXPECT_TRUE(may_be_mirrored(of_walls(1990.0)));
  EXPECT_FALSE(may_be_mirrored(of_walls(2010.0)));
  EXPECT_FALSE(may_be_mirrored(a_good_place())) << "nothing is against it";
}

/// What is left against a place beside the right one, once a cupboard is taken out.
TEST(Gates, KnowWhatAThingAloneHolds) {
  Support rest = a_good_place();
  EXPECT_TRUE(is_held_by_a_thing(rest, a_good_place()));
  rest.source_upright.displaced = 0.25;
  EXPECT_TRUE(is_held_by_a_thing(rest, a_good_place()));
  rest.source_upright.displaced = 0.35;
  EXPECT_FALSE(is_held_by_a_thing(rest, a_good_place())) << "something else holds it as well";
  Support good = a_good_place();
  good.source_upright.displaced = 0.1;
  EXPECT_TRUE(is_held_by_a_thing(rest, good));
  rest = a_good_place();
  for (Verdicts* v : {&rest.source_upright, &rest.target_upright}) v->matched = 10.0;
  for (Verdicts* v : {&rest.source_level, &rest.target_level}) v->matched = 4.0;
  EXPECT_FALSE(is_held_by_a_thing(rest, a_good_place())) << "hardly anything lies on anything";
}

TEST(Gates, KnowAMirrorImageThatHasLessInCommonButNothingAgainst) {
  Support found = a_good_place();
  found.source_upright.displaced = 3.0;
  Support mirrored = a_good_place();
  mirrored.source_upright.matched = mirrored.target_upright.matched = 32.0;
  EXPECT_TRUE(is_better_mirrored(mirrored, found));
  mirrored.source_upright.displaced = 2.0;
  EXPECT_FALSE(is_better_mirrored(mirrored, found)) << "as much is against it";
  mirrored = a_good_place();
  mirrored.source_upright.matched = mirrored.target_upright.matched = 28.0;
  EXPECT_FALSE(is_better_mirrored(mirrored, found)) << "any corner lies somewhere";
}

}  // namespace
}  // namespace concord
