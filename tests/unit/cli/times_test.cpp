#include "cli/times.hpp"

#include <cstdlib>
#include <ctime>

#include <gtest/gtest.h>

namespace concord {
namespace {

constexpr std::int64_t kNow = 1'800'000'000'000'000;  // 2027-01-15T08:00:00Z
constexpr std::int64_t kMinute = 60'000'000;

/// In a place two hours east of Greenwich in summer.
class Times : public testing::Test {
 protected:
  void SetUp() override {
    setenv("TZ", "CET-1CEST,M3.5.0,M10.5.0/3", 1);
    tzset();
  }
  void TearDown() override {
    unsetenv("TZ");
    tzset();
  }
};

TEST_F(Times, AnOffsetOrZSaysWhere) {
  EXPECT_EQ(parse_time("2027-01-15T08:00:00Z", 0).value(), kNow);
  EXPECT_EQ(parse_time("2027-01-15 09:30:00+01:30", 0).value(), kNow);
  EXPECT_EQ(parse_time("2027-01-15T03:00-0500", 0).value(), kNow);
  EXPECT_EQ(parse_time("2027-01-15T08:00:00.25Z", 0).value(), kNow + 250'000);
}

TEST_F(Times, WithoutOneItIsLocalTime) {
  EXPECT_EQ(parse_time("2027-01-15T09:00", 0).value(), kNow);
  EXPECT_EQ(parse_time("2027-01-15", 0).value(), kNow - 9 * 60 * kMinute);
  EXPECT_EQ(parse_time("2027-07-15T10:00", 0).value(), parse_time("2027-07-15T08:00Z", 0).value()) << "summer";
}

TEST_F(Times, ANumberWithAUnitIsSoLongAgo) {
  EXPECT_EQ(parse_time("30s", kNow).value(), kNow - kMinute / 2);
  EXPECT_EQ(parse_time("10m", kNow).value(), kNow - 10 * kMinute);
  EXPECT_EQ(parse_time("2h", kNow).value(), kNow - 120 * kMinute);
  EXPECT_EQ(parse_time("3d", kNow).value(), kNow - 3 * 24 * 60 * kMinute);
}

TEST_F(Times, RefusesWhatNoCalendarOrClockShows) {
  for (const char* text :
       {"", "now", "10", "10 m", "-5m", "2027-02-30", "2027-13-01", "2027-00-10", "2027-01-15T24:00",
        "2027-01-15T08:60", "2027-01-15T08:00:00.1234567Z", "2027-01-15T08:00+15:00", "9999999999d"}) {
    const auto time = parse_time(text, kNow);
    ASSERT_FALSE(time) << text;
    EXPECT_EQ(time.error().code, Code::kMalformed) << text;
  }
  EXPECT_EQ(parse_time(std::string(100'000, '1'), kNow).error().code, Code::kMalformed);
  EXPECT_EQ(parse_time("999999d", kNow).error().code, Code::kBadRequest);
  EXPECT_EQ(parse_time("999999999d", kNow).error().code, Code::kBadRequest) << "beyond what microseconds can count";
  EXPECT_EQ(parse_time("1969-12-31T00:00Z", kNow).error().code, Code::kBadRequest);
}

TEST_F(Times, AreSaidWhereTheProgramRunsAndInUtc) {
  EXPECT_EQ(format_local_time(kNow), "2027-01-15 09:00:00");
  EXPECT_EQ(format_utc_time(kNow + 1), "2027-01-15T08:00:00.000001Z");
  EXPECT_EQ(format_utc_time(-1), "1969-12-31T23:59:59.999999Z");
}

}  // namespace
}  // namespace concord
