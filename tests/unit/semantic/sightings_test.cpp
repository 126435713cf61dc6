#include "semantic/detections/sightings.hpp"

#include <gtest/gtest.h>

namespace concord {
namespace {

Transform at(double x, double y = 0, double angle = 0) {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(x, y, 0);
  return T;
}

class SightingsTest : public testing::Test {
 protected:
  Sightings::Seen see(const Transform& T, const std::string& object = "", const std::string& asset = "chair",
                      double score = 0.8) {
    Detection detection;
    detection.author = "hmd";
    detection.object = object;
    detection.score = score;
    detection.utime = ++now_;
    return *sightings_.see(detection, asset, asset, T, now_);
  }
  std::int64_t last_number_ = 0;
  Sightings sightings_{[this]() -> Result<std::int64_t> { return ++last_number_; }};
  std::int64_t now_ = 0;
};

TEST_F(SightingsTest, RepeatedSightingsOfOneObjectAreOneThingWhereTheyAgree) {
  EXPECT_TRUE(see(at(1.0)).is_new);
  EXPECT_FALSE(see(at(1.2)).is_new);
  EXPECT_FALSE(see(at(1.1, 0.1)).is_new);
  ASSERT_EQ(sightings_.list().size(), 1U);
  EXPECT_EQ(sightings_.list()[0].sightings, 3);
  EXPECT_NEAR(sightings_.list()[0].T_map_asset.translation().x(), 1.1, 1e-6);
}

TEST_F(SightingsTest, OtherAssetsAndOtherPlacesAreOtherThings) {
  EXPECT_EQ(see(at(1.0)).number, 1);
  EXPECT_EQ(see(at(1.0), "", "table").number, 2);
  EXPECT_EQ(see(at(1.6)).number, 3);
  EXPECT_EQ(see(at(1.35)).number, 3);  // the nearer one
  EXPECT_EQ(see(at(1.02)).number, 1);
}

TEST_F(SightingsTest, WhatIsFollowedUnderAnNameIsOneWhereverItGoes) {
  EXPECT_EQ(see(at(1.0), "target 7").number, 1);
  EXPECT_EQ(see(at(9.0), "target 7").number, 1);
  EXPECT_NEAR(sightings_.list()[0].T_map_asset.translation().x(), 9.0, 1e-6);
  EXPECT_EQ(see(at(9.1), "target 7", "table").number, 2);  // it was none
}

TEST_F(SightingsTest, AConfirmedThingMovesWhenThreeSightingsAgree) {
  see(at(1.0), "t");
  sightings_.put(1, "a1", at(1.0));
  EXPECT_FALSE(see(at(1.1), "t").moved_to);  // noise
  EXPECT_FALSE(see(at(4.0), "t").moved_to);
  EXPECT_FALSE(see(at(6.0), "t").moved_to);  // disagrees
  EXPECT_FALSE(see(at(6.05), "t").moved_to);
  EXPECT_EQ(sightings_.find(1)->T_map_asset.translation().x(), 1.0);  // it stays until it is moved
  const auto moved = see(at(6.1), "t");
  ASSERT_TRUE(moved.moved_to);
  EXPECT_NEAR(moved.moved_to->translation().x(), 6.05, 1e-6);
  EXPECT_FALSE(see(at(4.0), "t").moved_to);
  EXPECT_FALSE(see(at(1.0), "t").moved_to);
  EXPECT_FALSE(see(at(4.0), "t").moved_to);
  EXPECT_FALSE(see(at(4.0), "t").moved_to);  // it was seen in its place between
}

TEST_F(SightingsTest, ATurnedThingMovesToo) {
  see(at(1.0));
  sightings_.put(1, "a1", at(1.0));
  see(at(1.0, 0, 1.2));
  see(at(1.0, 0, 1.2));
  EXPECT_TRUE(see(at(1.0, 0, 1.2)).moved_to);
}

TEST_F(SightingsTest, WhoSeesItOffAsBeforeSeesItWhereItIs) {
  see(at(1.3));
  sightings_.put(1, "a1", at(1.0));  // it was fitted to the map
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(see(at(1.3)).moved_to);
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(see(at(0.6)).moved_to);
  ASSERT_TRUE(see(at(0.6)).moved_to);
  sightings_.seen_there(1);  // the fit says that it lies there all the same
  now_ += Sightings::kLongestPause;
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(see(at(0.6)).moved_to);
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(see(at(4.0), "t").moved_to);
}

TEST_F(SightingsTest, WhatIsNotMovedIsTriedLessAndLessOften) {
  see(at(1.0), "t");
  sightings_.put(1, "a1", at(1.0));
  int tried = 0;
  for (std::int64_t second = 0; second < 3600; ++second) {
    now_ = second * 1'000'000;
    if (see(at(6.0), "t").moved_to) ++tried;
  }
  EXPECT_GE(tried, 10);
  EXPECT_LE(tried, 20);
}

TEST_F(SightingsTest, WhatIsAlwaysOnItsWayIsMovedLessAndLessOftenUntilItLiesStillForLong) {
  see(at(0), "lift");
  sightings_.put(1, "a1", at(0));
  int moves = 0;
  const auto drive = [&](std::int64_t seconds) {
    for (std::int64_t second = 0; second < seconds; ++second) {
      now_ += 1'000'000;
      const auto seen = see(at(static_cast<double>(now_ / 20'000'000 % 2 * 9)), "lift");
      if (!seen.moved_to) continue;
      ++moves;
      sightings_.put(1, "a1", *seen.moved_to);
    }
  };
  drive(8 * 3600);
  EXPECT_GE(moves, 10);
  EXPECT_LE(moves, 10 + 8 * 6);
  for (int minute = 0; minute < 240; ++minute) {
    now_ += 60'000'000;
    if (const auto seen = see(at(0), "lift"); seen.moved_to) sightings_.put(1, "a1", *seen.moved_to);
  }
  const int before = moves;
  drive(60);
  EXPECT_GE(moves, before + 2) << "the next morning";
}

TEST_F(SightingsTest, WhatWasDroppedIsNotToldOfUntilNobodySawItForLong) {
  ASSERT_EQ(see(at(1.0)).number, 1);
  sightings_.drop(1);
  EXPECT_TRUE(sightings_.list().empty());
  EXPECT_EQ(sightings_.find(1), nullptr);
  for (int i = 0; i < 100; ++i) {
    now_ += Sightings::kDroppedFor / 2;
    sightings_.forget_dropped(now_);
    const auto seen = see(at(1.1));
    EXPECT_TRUE(seen.is_dropped);
    EXPECT_EQ(seen.number, 1) << "and it spends no number";
  }
  EXPECT_EQ(see(at(3.0)).number, 2) << "another";
  now_ += Sightings::kDroppedFor + 1;
  sightings_.forget_dropped(now_);
  const auto again = see(at(1.0));
  EXPECT_EQ(again.number, 3);
  EXPECT_TRUE(again.is_new);
}

TEST_F(SightingsTest, WhatWasDroppedSwallowsNothingOfWhatIsPutThere) {
  ASSERT_EQ(see(at(1.0), "track-7").number, 1);
  sightings_.drop(1);
  sightings_.add("chair", "chair", "by-hand", at(1.2));
  EXPECT_EQ(see(at(1.2), "track-7").number, 2);
  for (int i = 1; i < Sightings::kAgreeing; ++i) EXPECT_FALSE(see(at(4.0), "track-7").moved_to);
  EXPECT_TRUE(see(at(4.0), "track-7").moved_to) << "it is carried off";
}

TEST_F(SightingsTest, WhatIsCarriedOffNowAndThenIsSoonMoved) {
  ASSERT_TRUE(see(at(0), "pallet").is_new);
  sightings_.put(1, "c1", at(0));
  const auto seen_for = [&](const Transform& place, std::int64_t seconds) {
    for (std::int64_t i = 0; i < seconds; ++i) {
      now_ += 1'000'000;
      if (see(place, "pallet").moved_to) {
        sightings_.put(1, "c1", place);
        return i;
      }
    }
    return seconds;
  };
  for (int move = 1; move <= 30; ++move) {
    EXPECT_LT(seen_for(at(move), 3000), 15) << "move " << move;
    EXPECT_EQ(seen_for(at(move), 3000), 3000) << "it lies still";
  }
}

TEST_F(SightingsTest, AClockThatIsWrongKeepsNothingAlive) {
  Detection ahead;
  ahead.utime = std::int64_t{1} << 60;
  for (std::size_t i = 0; i < kMaxThings; ++i) {
    now_ = static_cast<std::int64_t>(i) + 1;
    if (i < 500) {
      ASSERT_TRUE(sightings_.see(ahead, "chair", "chair", at(10.0 * static_cast<double>(i)), now_));
    } else {
      see(at(10.0 * static_cast<double>(i)));
    }
  }
  EXPECT_TRUE(see(at(-10)).is_new);
  EXPECT_EQ(sightings_.find(1), nullptr) << "seen first by our clock";
  EXPECT_NE(sightings_.find(501), nullptr);
}

TEST_F(SightingsTest, NamesOfFollowersAreBounded) {
  for (int i = 0; i < 1000; ++i) see(at(1.0), "object " + std::to_string(i));
  EXPECT_EQ(see(at(1.0), "object 999").number, 1);
  EXPECT_EQ(see(at(9.0), "object 999").number, 1);
  EXPECT_EQ(see(at(1.0), "object 1").number, 2) << "it has another name now";
  Detection detection;
  for (int i = 0; i < 100; ++i) {
    detection.author = "robot" + std::to_string(i);
    detection.object = "it";
    ASSERT_TRUE(sightings_.see(detection, "chair", "chair", at(20.0), 0));
  }
  detection.author = "robot99";
  EXPECT_EQ(sightings_.see(detection, "chair", "chair", at(25.0), 0)->number, 3);
}

TEST_F(SightingsTest, WithoutANumberNothingIsAThing) {
  Sightings full([]() -> Result<std::int64_t> { return refuse(Code::kIo, "the disk is full"); });
  EXPECT_EQ(full.see({}, "chair", "chair", at(0), 0).error().code, Code::kIo);
  EXPECT_TRUE(full.list().empty());
}

TEST_F(SightingsTest, IsBoundedAndLetsGoOfTheOldestThatNobodyConfirmed) {
  for (std::size_t i = 0; i < kMaxThings; ++i) see(at(10.0 * static_cast<double>(i)));
  sightings_.put(1, "a1", at(0));
  EXPECT_TRUE(see(at(-10)).is_new);
  EXPECT_EQ(sightings_.list().size(), kMaxThings);
  EXPECT_NE(sightings_.find(1), nullptr);
  EXPECT_EQ(sightings_.find(2), nullptr);
  for (const Thing& thing : sightings_.list()) sightings_.put(thing.number, "a", thing.T_map_asset);
  Detection detection;
  EXPECT_EQ(sightings_.see(detection, "chair", "chair", at(-50), 0).error().code, Code::kTooLarge);
}

}  // namespace
}  // namespace concord
