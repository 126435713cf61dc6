#include "core/byte_stream.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>

namespace concord {
namespace {

RC_GTEST_PROP(Varint, ComesBackAndTakesOnlyItsOwnBytes, (std::uint64_t value, unsigned shift, std::uint8_t after)) {
  value >>= shift % 64;
  Bytes bytes;
  append_varint(bytes, value);
  RC_ASSERT(bytes.size() <= kMaxVarintBytes);
  bytes.push_back(after);
  ByteSpan in = bytes;
  RC_ASSERT(read_varint(in) == value);
  RC_ASSERT(in.size() == 1u);
}

RC_GTEST_PROP(Varint, WhatIsAcceptedIsTheShortestForm, (const Bytes& bytes)) {
  ByteSpan in = bytes;
  const auto value = read_varint(in);
  if (!value) {
    RC_ASSERT(in.size() == bytes.size());
    return;
  }
  Bytes again;
  append_varint(again, *value);
  RC_ASSERT(again == Bytes(bytes.begin(), bytes.end() - static_cast<std::ptrdiff_t>(in.size())));
}

TEST(Varint, RefusesOverlongTruncatedAndOverflowing) {
  const std::vector<Bytes> bad{{},
                               {0x80},
                               {0x80, 0x00},
                               {0xff, 0x80, 0x00},
                               {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x02},
                               {0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x01}};
  for (const Bytes& bytes : bad) {
    ByteSpan in = bytes;
    EXPECT_FALSE(read_varint(in).has_value());
    EXPECT_EQ(in.size(), bytes.size());
  }
}

RC_GTEST_PROP(Zigzag, ComesBack, (std::int64_t value)) { RC_ASSERT(unzigzag(zigzag(value)) == value); }

TEST(Zigzag, SmallNumbersStaySmall) {
  EXPECT_EQ(zigzag(0), 0u);
  EXPECT_EQ(zigzag(-1), 1u);
  EXPECT_EQ(zigzag(1), 2u);
  EXPECT_EQ(zigzag(std::numeric_limits<std::int64_t>::min()), std::numeric_limits<std::uint64_t>::max());
}

RC_GTEST_PROP(LittleEndian, ComesBackLowestByteFirst, (std::int32_t value)) {
  Bytes bytes;
  append_le(bytes, value);
  RC_ASSERT(bytes.size() == 4u);
  RC_ASSERT(bytes[0] == static_cast<std::uint8_t>(value & 0xff));
  ByteSpan in = bytes;
  RC_ASSERT(read_le<std::int32_t>(in) == value);
  RC_ASSERT(!read_le<std::uint8_t>(in).has_value());
}

}  // namespace
}  // namespace concord
