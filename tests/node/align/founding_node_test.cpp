#include "align_station.hpp"
#include "store/whole_file.hpp"

// The map is founded in two halves. Whoever goes away between them, both are done, or none is.

namespace concord::test {
namespace {

class FoundingStation : public AlignStation {
 protected:
  FoundingStation() {
    send("robot1", left_part());
    send("robot2", right_part());
    EXPECT_TRUE(found(guess_of("a", "robot2", "robot1", kT_left_right)).ok);
  }
  [[nodiscard]] std::size_t placements_of(const std::string& agent) const {
    return static_cast<std::size_t>(std::ranges::count(placements_, agent, &TransformRequest::agent));
  }
  [[nodiscard]] bool is_kept() const { return std::filesystem::exists(site_.state / "founding"); }
};

TEST_F(FoundingStation, IsCompletedThoughNobodyAsksAgain) {
  EXPECT_EQ(accept("d", "a").code, "BUSY");
  EXPECT_TRUE(is_kept());
  run(5'000'000);
  EXPECT_TRUE(lies_in_map("robot1"));
  EXPECT_TRUE(lies_in_map("robot2"));
  EXPECT_EQ(placements_.back().id, "d");
  EXPECT_EQ(placements_.back().author, "eva");
  EXPECT_FALSE(is_kept());
  const std::size_t asked = placements_.size();
  run(5'000'000);
  EXPECT_EQ(placements_.size(), asked) << "merge is asked for ever";
}

TEST_F(FoundingStation, IsCompletedThoughTheProcessEndsBetweenTheHalves) {
  EXPECT_EQ(accept("d", "a").code, "BUSY");
  const TransformRequest first = placements_.at(0);
  ASSERT_TRUE(lies_in_map("robot1"));
  ASSERT_FALSE(lies_in_map("robot2"));
  start();
  run(5'000'000);
  EXPECT_TRUE(lies_in_map("robot2"));
  EXPECT_EQ(placements_.back().id, "d");
  EXPECT_LT(metres_off(placements_.back().T_map_agent, kT_left_right), 0.08);
  EXPECT_EQ(first.agent, "robot1");
  EXPECT_FALSE(is_kept());
}

TEST_F(FoundingStation, BeginsAnewWithTheVeryRequestThatMergeDidNotHear) {
  merge_ = Merge::kIsDown;
  EXPECT_EQ(accept("d", "a").code, "BUSY");
  start();
  merge_ = Merge::kPlaces;
  run(5'000'000);
  EXPECT_TRUE(lies_in_map("robot1"));
  EXPECT_TRUE(lies_in_map("robot2"));
  ASSERT_GE(placements_.size(), 3U);
  EXPECT_EQ(encode(placements_[1], 0), encode(placements_[0], 0)) << "merge would refuse another one of this id";
}

TEST_F(FoundingStation, IsTakenBackWhenMergeRefusesTheSecondHalf) {
  refused_agent_ = "robot2";
  for (const bool restarts : {false, true}) {
    ASSERT_TRUE(found(guess_of(restarts ? "b" : "a", "robot2", "robot1", kT_left_right)).ok);
    EXPECT_EQ(accept(restarts ? "e" : "d", restarts ? "b" : "a").code, "BUSY");
    ASSERT_TRUE(lies_in_map("robot1"));
    if (restarts) start();
    run(10'000'000);
    EXPECT_GE(placements_of("robot2"), 1U);
    EXPECT_FALSE(lies_in_map("robot1")) << "half a map";
    EXPECT_FALSE(is_kept());
  }
}

TEST_F(FoundingStation, IsTakenBackWhenItIsDropped) {
  EXPECT_EQ(accept("d", "a").code, "BUSY");
  ASSERT_TRUE(lies_in_map("robot1"));
  EXPECT_TRUE(decide("e", AlignDecision::Op::kDrop, "a").ok);
  run(5'000'000);
  EXPECT_FALSE(lies_in_map("robot1"));
  EXPECT_FALSE(lies_in_map("robot2"));
  EXPECT_FALSE(is_kept());
}

TEST_F(FoundingStation, WhomPeoplePlacedMeanwhileIsLeftThere) {
  EXPECT_EQ(accept("d", "a").code, "BUSY");
  set_place("robot1", transform(3, 2, 0, 0));
  start();
  run(5'000'000);
  EXPECT_EQ(placements_of("robot2"), 0U);
  EXPECT_TRUE(lies_in_map("robot1"));
  EXPECT_FALSE(is_kept());
}

TEST_F(FoundingStation, WhatIsNoFoundingIsNotTakenUp) {
  EXPECT_EQ(accept("d", "a").code, "BUSY");
  const Bytes whole = read_whole_file(site_.state / "founding", kMaxFoundingBytes).value();
  ASSERT_TRUE(founding_of(whole));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(founding_of(ByteSpan(whole).first(size))) << size;
  }
  Bytes longer = whole;
  longer.push_back(0);
  EXPECT_FALSE(founding_of(longer));
  longer.resize(kMaxFoundingBytes + 1);
  ASSERT_TRUE(write_whole_file(site_.state / "founding", longer));
  start();
  EXPECT_EQ(counters_.get("refused.founding.TOO_LARGE"), 1);
  run();
  EXPECT_EQ(placements_of("robot2"), 0U);
}

}  // namespace
}  // namespace concord::test
