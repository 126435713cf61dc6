#include "align_station.hpp"

namespace concord::test {
namespace {

constexpr std::int64_t kLong = 150'000'000;

class DriftStation : public AlignStation {
 protected:
  DriftStation() {
    send("robot1", left_part());
    send("robot2", right_part());
    align_by_hand("robot1", Transform::Identity());
  }
  /// What the watch says now. A look takes as long as it takes on this machine, and is paid for by a pause.
  std::vector<AlignResult> said() {
    run(kLong);
    results_.clear();
    run(1'000'000);
    return results_;
  }
};

TEST_F(DriftStation, WhoLiesRightIsLeftAlone) {
  align_by_hand("robot2", kT_left_right);
  EXPECT_TRUE(said().empty());
  EXPECT_GE(counters_.all().at("looks"), 2) << "nobody was looked at";
  EXPECT_TRUE(placements_.empty());
}

TEST_F(DriftStation, WhoHasSlippedIsToldOfAndNotMoved) {
  align_by_hand("robot2", transform(0.2, -0.15, 0.0, degrees(1.5)) * kT_left_right);
  const auto offers = said();
  ASSERT_FALSE(offers.empty());
  const AlignResult& offer = offers.back();
  EXPECT_EQ(offer.author, "");
  EXPECT_TRUE(offer.open);
  EXPECT_GT(offer.slip, 0.1);
  EXPECT_NE(offer.evidence.message.find("slipped"), std::string::npos) << offer.evidence.message;
  EXPECT_TRUE(placements_.empty()) << "moved silently";
  EXPECT_GE(counters_.all().at("slipped"), 1);
}

TEST_F(DriftStation, TheOfferPutsItRightAndIsWithdrawn) {
  align_by_hand("robot2", transform(0.2, -0.15, 0.0, degrees(1.5)) * kT_left_right);
  AlignResult offer;
  for (const AlignResult& one : said()) {
    if (one.source.agent == "robot2") offer = one;
  }
  ASSERT_EQ(offer.source.agent, "robot2");
  EXPECT_TRUE(accept("d", offer.id).ok);
  ASSERT_EQ(placements_.size(), 1U);
  EXPECT_LT(metres_off(placements_[0].T_map_agent, kT_left_right), 0.08);
  EXPECT_TRUE(said().empty());
}

TEST_F(DriftStation, WhatTheOthersContradictIsSaidWithoutAnOffer) {
  send("robot2", other_room());
  align_by_hand("robot2", transform(0.6, 0.9, 0.0, 0.5));
  const auto said_now = said();
  ASSERT_FALSE(said_now.empty());
  EXPECT_FALSE(said_now.back().open);
  EXPECT_NE(said_now.back().evidence.message.find("contradict"), std::string::npos);
  EXPECT_TRUE(placements_.empty());
}

/// Farther than a recheck reaches, nearer than where nothing fits: neither is met with silence.
TEST_F(DriftStation, WhoSlipsFartherAndFartherIsToldOfAllTheWay) {
  for (const double slip : {0.25, 0.5}) {
    align_by_hand("robot2", transform(slip, 0.3 * slip, 0.0, degrees(3)) * kT_left_right);
    const auto offers = said();
    ASSERT_FALSE(offers.empty()) << slip;
    EXPECT_TRUE(offers.back().open) << slip << ": " << offers.back().evidence.message;
    EXPECT_GT(offers.back().slip, 0.1) << slip;
  }
  EXPECT_TRUE(placements_.empty());
}

TEST_F(DriftStation, OnceOneIsPutRightNothingIsSaidOfTheOther) {
  align_by_hand("robot2", transform(0.2, -0.15, 0.0, degrees(1.5)) * kT_left_right);
  std::map<std::string, AlignResult> offers;
  for (const AlignResult& one : said()) offers[one.source.agent] = one;
  ASSERT_EQ(offers.size(), 2U) << "each lies wrong by the other";
  ASSERT_TRUE(accept("d", offers["robot2"].id).ok);
  run();
  results_.clear();
  run(3'000'000);
  EXPECT_TRUE(results_.empty()) << "it was found where robot2 lay then: " << results_.back().evidence.message;
  EXPECT_EQ(accept("e", offers["robot1"].id).code, "EXPIRED");
}

TEST_F(DriftStation, TheOthersAreLookedAtAgainWhenOneIsMoved) {
  align_by_hand("robot2", kT_left_right);
  run(kLong);
  const std::int64_t looks = counters_.all().at("looks");
  align_by_hand("robot2", transform(0.01, 0.0, 0.0, 0.0) * kT_left_right);
  run(kLong);
  EXPECT_EQ(counters_.all().at("looks"), looks + 2);
}

TEST_F(DriftStation, AnOfferIsFoundAnewWhenItExpires) {
  align_by_hand("robot2", transform(0.2, -0.15, 0.0, degrees(1.5)) * kT_left_right);
  const auto before = said();
  ASSERT_FALSE(before.empty());
  run(AlignDesk::kOpenFor);
  const auto after = said();
  ASSERT_FALSE(after.empty()) << "it lies as wrong as before";
  EXPECT_NE(after.back().id, before.back().id);
  EXPECT_TRUE(after.back().open);
  EXPECT_TRUE(accept("d", after.back().id).ok);
}

TEST_F(DriftStation, WhatWasDroppedDoesNotComeBackWhenTheAgentMovesOn) {
  align_by_hand("robot2", transform(0.2, -0.15, 0.0, degrees(1.5)) * kT_left_right);
  for (const AlignResult& one : said()) decide("drop-" + one.id, AlignDecision::Op::kDrop, one.id);
  EXPECT_TRUE(said().empty()) << "not dropped";
  const std::int64_t looks = counters_.all().at("looks");
  map_on("robot2");
  EXPECT_TRUE(said().empty());
  EXPECT_GT(counters_.all().at("looks"), looks) << "nobody was looked at";
}

TEST_F(DriftStation, LooksAreBoundedAndOnlyAtWhoSentSomething) {
  align_by_hand("robot2", kT_left_right);
  run(60'000'000);
  const std::int64_t looks = counters_.all().at("looks");
  EXPECT_LE(looks, 3);
  run(60'000'000);
  EXPECT_EQ(counters_.all().at("looks"), looks);
}

}  // namespace
}  // namespace concord::test
