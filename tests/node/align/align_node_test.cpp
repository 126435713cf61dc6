#include "align_station.hpp"

namespace concord::test {
namespace {

constexpr double kNear = 0.08;  // metres: both are in voxels of 0.05
const Transform kT_map_left = transform(10.0, 5.0, 0.0, 0.3);

TEST_F(AlignStation, FindsAnAgentInTheMapAndSaysWhatItUsed) {
  send("robot1", left_part());
  send("robot2", right_part(), "odom");
  align_by_hand("robot1", kT_map_left);
  const Answer answer = found(guess_of("a", "robot2", "", kT_map_left * kT_left_right));
  EXPECT_TRUE(answer.ok) << answer.code << ": " << answer.message;
  ASSERT_FALSE(results_.empty());
  const AlignResult& result = results_.back();
  EXPECT_TRUE(result.open);
  EXPECT_EQ(result.author, "eva");
  EXPECT_EQ(result.target, "");
  EXPECT_EQ(result.source.agent, "robot2");
  EXPECT_EQ(result.source.frame_id, "odom");
  EXPECT_GT(result.source.revision, 0);
  ASSERT_EQ(result.layers.size(), 1U);
  EXPECT_EQ(result.layers[0].agent, "robot1");
  EXPECT_GT(result.layers[0].revision, 0);
  EXPECT_LT(metres_off(result.evidence.T_target_source, kT_map_left * kT_left_right), kNear);
  EXPECT_TRUE(placements_.empty()) << "moved before anybody accepted it";
}

TEST_F(AlignStation, WhatIsAcceptedGoesToMergeInTheNameOfWhoAcceptedIt) {
  send("robot1", left_part());
  send("robot2", right_part(), "odom");
  align_by_hand("robot1", kT_map_left);
  ASSERT_TRUE(found(guess_of("a", "robot2", "", kT_map_left * kT_left_right)).ok);
  const Answer answer = accept("d", "a");
  EXPECT_TRUE(answer.ok);
  EXPECT_EQ(answer.process, "merge");
  ASSERT_EQ(placements_.size(), 1U);
  EXPECT_EQ(placements_[0].id, "d");
  EXPECT_EQ(placements_[0].author, "eva");
  EXPECT_EQ(placements_[0].agent, "robot2");
  EXPECT_EQ(placements_[0].frame_id, "odom");
  EXPECT_TRUE(placements_[0].T_map_agent.isApprox(results_.back().evidence.T_target_source, 1e-6));

  // Its answer was lost: the same once more. Another decision comes too late.
  EXPECT_TRUE(accept("d", "a").ok);
  ASSERT_EQ(placements_.size(), 2U);
  EXPECT_TRUE(placements_[1].T_map_agent.isApprox(placements_[0].T_map_agent, 1e-12));
  EXPECT_EQ(accept("e", "a").code, "CONFLICT");
  EXPECT_EQ(decide("f", AlignDecision::Op::kDrop, "a").code, "CONFLICT");
  EXPECT_EQ(placements_.size(), 2U);
}

TEST_F(AlignStation, WhatMergeRefusesCanBeAcceptedLater) {
  send("robot1", left_part());
  send("robot2", right_part());
  align_by_hand("robot1", kT_map_left);
  ASSERT_TRUE(found(guess_of("a", "robot2", "", kT_map_left * kT_left_right)).ok);
  merge_ = Merge::kRefuses;
  EXPECT_EQ(accept("d", "a").code, "LOCKED");
  results_.clear();
  run();
  ASSERT_FALSE(results_.empty()) << "no longer offered";
  EXPECT_TRUE(results_.back().open);
  merge_ = Merge::kIsDown;
  EXPECT_EQ(accept("e", "a").id, "") << "nobody knows yet";
  merge_ = Merge::kPlaces;
  EXPECT_TRUE(accept("f", "a").ok);
  EXPECT_EQ(accept("g", "a").code, "CONFLICT");
  ASSERT_EQ(placements_.size(), 3U);
  EXPECT_EQ(placements_[2].id, "f");
}

TEST_F(AlignStation, WhatShowsInTheMapIsAcceptedThoughMergesAnswerWasLost) {
  send("robot1", left_part());
  send("robot2", right_part());
  align_by_hand("robot1", kT_map_left);
  ASSERT_TRUE(found(guess_of("a", "robot2", "", kT_map_left * kT_left_right)).ok);
  merge_ = Merge::kPlacesAndIsNotHeard;
  EXPECT_EQ(accept("d", "a").id, "");
  run();
  EXPECT_EQ(accept("e", "a").code, "CONFLICT");
  results_.clear();
  run();
  EXPECT_TRUE(results_.empty()) << "offered all the same: " << results_.back().evidence.message;
}

TEST_F(AlignStation, TheFirstPairFoundsTheMapInTheTargetsFrame) {
  send("robot1", left_part());
  send("robot2", right_part());
  ASSERT_TRUE(found(guess_of("a", "robot2", "robot1", kT_left_right)).ok);
  EXPECT_EQ(results_.back().target, "robot1");
  Answer answer = accept("d", "a");
  EXPECT_EQ(answer.code, "BUSY");
  ASSERT_EQ(placements_.size(), 1U);
  EXPECT_EQ(placements_[0].agent, "robot1");
  EXPECT_NE(placements_[0].id, "d");
  EXPECT_TRUE(placements_[0].T_map_agent.isApprox(Transform::Identity()));
  run();
  answer = accept("d", "a");
  EXPECT_TRUE(answer.ok);
  ASSERT_GE(placements_.size(), 2U);
  EXPECT_EQ(placements_.back().agent, "robot2");
  EXPECT_LT(metres_off(placements_.back().T_map_agent, kT_left_right), kNear);
}

TEST_F(AlignStation, OnePairAloneFoundsTheMap) {
  send("robot1", left_part());
  send("robot2", right_part());
  send("robot3", left_part());
  send("robot4", right_part());
  ASSERT_TRUE(found(guess_of("a", "robot2", "robot1", kT_left_right)).ok);
  ASSERT_TRUE(found(guess_of("b", "robot4", "robot3", kT_left_right)).ok);
  merge_ = Merge::kIsDown;
  EXPECT_EQ(accept("d", "a").code, "BUSY");
  EXPECT_EQ(accept("e", "b").code, "BUSY");
  ASSERT_EQ(placements_.size(), 1U) << "the map was founded twice";
  EXPECT_EQ(placements_[0].agent, "robot1");
  // Merge says no to the first: then the other may.
  merge_ = Merge::kRefuses;
  EXPECT_EQ(accept("d", "a").code, "BUSY");
  merge_ = Merge::kPlaces;
  EXPECT_EQ(accept("e", "b").code, "BUSY");
  EXPECT_EQ(placements_.back().agent, "robot3");
  run();
  EXPECT_TRUE(accept("e", "b").ok);
  EXPECT_EQ(accept("d", "a").code, "NOT_ALIGNED") << "it is another map's";
}

TEST_F(AlignStation, NobodyFoundsAMapThatSomebodyWithoutASubmapIsIn) {
  send("robot1", left_part());
  send("robot2", right_part());
  align_without_submap("headset");
  ASSERT_TRUE(found(guess_of("a", "robot2", "robot1", kT_left_right)).ok);
  EXPECT_EQ(accept("d", "a").code, "NOT_ALIGNED");
  EXPECT_TRUE(placements_.empty());
}

TEST_F(AlignStation, AnAgentFoundInAnotherLiesInTheMapWhereThatOneDoes) {
  send("robot1", left_part());
  send("robot2", right_part());
  align_by_hand("robot1", kT_map_left);
  ASSERT_TRUE(found(guess_of("a", "robot2", "robot1", kT_left_right)).ok);
  ASSERT_TRUE(accept("d", "a").ok);
  EXPECT_LT(metres_off(placements_.at(0).T_map_agent, kT_map_left * kT_left_right), kNear);
}

TEST_F(AlignStation, AnotherRoomIsRefusedAndCannotBeAccepted) {
  send("robot1", left_part());
  send("robot2", other_room());
  align_by_hand("robot1", kT_map_left);
  const Answer answer = found(guess_of("a", "robot2", "", kT_map_left * kT_left_right));
  EXPECT_FALSE(answer.ok);
  ASSERT_FALSE(results_.empty());
  EXPECT_EQ(answer.code, name(results_.back().evidence.reason));
  EXPECT_FALSE(results_.back().open);
  EXPECT_EQ(accept("d", "a").code, "BAD_REQUEST");
  EXPECT_TRUE(placements_.empty());
}

TEST_F(AlignStation, WhatNoLongerHoldsCannotBeAccepted) {
  send("robot1", left_part());
  send("robot2", right_part());
  align_by_hand("robot1", kT_map_left);
  ASSERT_TRUE(found(guess_of("a", "robot2", "", kT_map_left * kT_left_right)).ok);
  align_by_hand("robot1", kT_map_left * transform(0.5, 0, 0, 0));
  EXPECT_EQ(accept("d", "a").code, "STALE");
  results_.clear();
  run();
  EXPECT_TRUE(results_.empty()) << "offered though it cannot be accepted";
  align_by_hand("robot1", kT_map_left);
  send("robot2", right_part(), "frame2");
  EXPECT_EQ(accept("d", "a").code, "BAD_FRAME");
  EXPECT_EQ(accept("d", "nobody").code, "EXPIRED");
  EXPECT_TRUE(placements_.empty());
}

TEST_F(AlignStation, AnAnswerIsRepeatedForTenMinutesAndThenExpires) {
  send("robot1", left_part());
  send("robot2", right_part());
  align_by_hand("robot1", kT_map_left);
  ASSERT_TRUE(found(guess_of("a", "robot2", "", kT_map_left * kT_left_right)).ok);
  results_.clear();
  run(3'000'000);
  EXPECT_EQ(results_.size(), 3U);
  run(600'000'000);
  results_.clear();
  run(3'000'000);
  EXPECT_TRUE(results_.empty());
  EXPECT_EQ(accept("d", "a").code, "EXPIRED");
}

TEST_F(AlignStation, RequestsQueueAndCanBeDropped) {
  send("robot1", left_part());
  send("robot2", right_part());
  align_by_hand("robot1", kT_map_left);
  for (int i = 0; i < 16; ++i) {
    const Transform T = kT_map_left * kT_left_right;
    EXPECT_EQ(request(guess_of("a" + std::to_string(i), "robot2", "", T)).code, "BUSY");
  }
  EXPECT_EQ(request(request_of("b", "robot2")).code, "BUSY");
  const Answer third = request(guess_of("a3", "robot2", "", kT_map_left * kT_left_right));
  EXPECT_EQ(third.code, "BUSY");
  EXPECT_NE(third.message.find("3 are before it"), std::string::npos) << third.message;
  for (int i = 1; i < 16; ++i) {
    EXPECT_TRUE(decide("d" + std::to_string(i), AlignDecision::Op::kDrop, "a" + std::to_string(i)).ok);
  }
  EXPECT_TRUE(decide("d3", AlignDecision::Op::kDrop, "a3").ok) << "the answer may have been lost";
  EXPECT_EQ(request(guess_of("a3", "robot2", "", kT_map_left * kT_left_right)).code, "EXPIRED") << "who asked asks on";
  EXPECT_EQ(decide("e", AlignDecision::Op::kAccept, "a3").code, "EXPIRED");
  run();
  EXPECT_EQ(counters_.all().at("requests.ACCEPTED"), 1) << "what was dropped was carried out";
}

TEST_F(AlignStation, RefusesWhatCannotBeDone) {
  EXPECT_EQ(request(request_of("a", "robot1")).code, "BUSY") << "it may come yet";
  run();
  EXPECT_EQ(request(request_of("a", "robot1")).code, "NO_AGENT");
  send("robot1", left_part());
  EXPECT_EQ(request(request_of("a", "robot1")).code, "NO_MAP");
  EXPECT_EQ(request(request_of("a", "robot1", "robot1")).code, "BAD_REQUEST");
  EXPECT_EQ(request(request_of("a", "robot1", "robot2")).code, "NO_AGENT");
  AlignRequest in_frame = request_of("a", "robot1");
  in_frame.source_frame_id = "frame7";
  EXPECT_EQ(request(in_frame).code, "BAD_FRAME");
  send("robot2", right_part());
  align_by_hand("robot2", Transform::Identity());
  ASSERT_TRUE(found(guess_of("a", "robot1", "", kT_left_right.inverse())).ok);
  EXPECT_EQ(request(request_of("a", "robot2", "robot1")).code, "EXISTS");
}

/// Else it would be found where it lies, whatever is wrong with that.
TEST_F(AlignStation, AnAgentInTheMapIsNotComparedWithItself) {
  send("robot1", left_part());
  send("robot2", right_part());
  align_by_hand("robot1", kT_map_left);
  align_by_hand("robot2", kT_map_left * kT_left_right * transform(1.0, 0.5, 0, 0.2));
  ASSERT_TRUE(found(guess_of("a", "robot2", "", kT_map_left * kT_left_right)).ok);
  EXPECT_LT(metres_off(results_.back().evidence.T_target_source, kT_map_left * kT_left_right), kNear);
}

}  // namespace
}  // namespace concord::test
