#include <gtest/gtest.h>

#include "bus/wire_layout.hpp"
#include "core/byte_stream.hpp"

namespace concord {
namespace {

constexpr WireField kRow[] = {count(3), array(1)};

/// A message of these bytes, behind a fingerprint.
WireFit fit(std::initializer_list<int> bytes, std::span<const WireField> layout) {
  Bytes message(8);
  for (const int byte : bytes) message.push_back(static_cast<std::uint8_t>(byte));
  return check_layout(message, layout).fit;
}

TEST(WireLayout, CountsWithinRecordsLeaveTheOneBeforeThemAsItWas) {
  static constexpr WireField kLayout[] = {count(4), records(kRow), array(2)};
  // Two rows, of 3 and of 1, then twice two bytes.
  EXPECT_EQ(fit({0, 0, 0, 2, 0, 0, 0, 3, 7, 7, 7, 0, 0, 0, 1, 7, 8, 8, 8, 8}, kLayout), WireFit::kFits);
  EXPECT_EQ(fit({0, 0, 0, 2, 0, 0, 0, 3, 7, 7, 7, 0, 0, 0, 1, 7, 8, 8}, kLayout), WireFit::kMalformed);
  // A first row of none does not end the rows.
  EXPECT_EQ(fit({0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 1, 7, 8, 8, 8, 8}, kLayout), WireFit::kFits);
  EXPECT_EQ(fit({0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0}, kLayout), WireFit::kMalformed);
  EXPECT_EQ(fit({0, 0, 0, 2, 0, 0, 0, 1, 7, 0, 0, 0, 4, 7, 7, 7, 7, 8, 8, 8, 8}, kLayout), WireFit::kTooLarge);
  EXPECT_EQ(fit({0, 0, 0, 0}, kLayout), WireFit::kFits);
}

TEST(WireLayout, ARecordStandsOnceWhateverWasCounted) {
  static constexpr WireField kLayout[] = {count(4), record(kRow), array(2)};
  EXPECT_EQ(fit({0, 0, 0, 2, 0, 0, 0, 1, 7, 8, 8, 8, 8}, kLayout), WireFit::kFits);
  EXPECT_EQ(fit({0, 0, 0, 0, 0, 0, 0, 1, 7}, kLayout), WireFit::kFits);
  EXPECT_EQ(fit({0, 0, 0, 0}, kLayout), WireFit::kMalformed);
}

TEST(WireLayout, RecordsWithinRecordsAreWalkedEach) {
  static constexpr WireField kTable[] = {count(2), records(kRow)};
  static constexpr WireField kLayout[] = {count(2), records(kTable), fixed(1)};
  EXPECT_EQ(fit({0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0, 2, 7, 7, 0, 0, 0, 0, 9}, kLayout), WireFit::kFits);
  EXPECT_EQ(fit({0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0, 2, 7, 7, 9}, kLayout), WireFit::kMalformed);
}

}  // namespace
}  // namespace concord
