#include "align_station.hpp"

namespace concord::test {
namespace {

class DriftStation : public AlignStation {
 protected:
  DriftStation() {
    send("robot1", left_part());
    send("robot2", right_part());
    align_by_hand("robot1", Transform::Identity());
  }
  /// What the watch says now.
  std::vector<AlignResult> said() {
    run(20'000'000);
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
