#include "core/brick_codec.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "arbitrary.hpp"

namespace concord {
namespace {

using test::arbitrary_brick;

Bytes encoded(const Brick& brick) {
  Bytes bytes;
  append_brick(bytes, brick);
  return bytes;
}

bool refused(const Bytes& bytes) {
  ByteSpan in = bytes;
  const Result<Brick> brick = read_brick(in);
  return !brick && brick.error().code == Code::kMalformed && in.size() == bytes.size();
}

Brick striped(int voxels, int values) {
  DenseBrick dense;
  dense.fill(kUnknown);
  for (int i = 0; i < voxels; ++i) dense[i] = static_cast<LogOdds>(i % values * 7 - 1000);
  return Brick::from_dense(dense);
}

RC_GTEST_PROP(BrickCodec, BricksOfARunComeBackOneAfterTheOther, ()) {
  const auto bricks = *rc::gen::container<std::vector<Brick>>(arbitrary_brick());
  Bytes bytes;
  for (const Brick& brick : bricks) append_brick(bytes, brick);
  ByteSpan in = bytes;
  for (const Brick& brick : bricks) {
    const Result<Brick> read = read_brick(in);
    RC_ASSERT(read.has_value());
    RC_ASSERT(*read == brick);
  }
  RC_ASSERT(in.empty());
}

RC_GTEST_PROP(BrickCodec, NoBrickExceedsTheStatedBound, ()) {
  RC_ASSERT(encoded(*arbitrary_brick()).size() <= kMaxBrickBytes);
}

RC_GTEST_PROP(BrickCodec, EveryProperPrefixIsRefused, ()) {
  Bytes bytes = encoded(*arbitrary_brick());
  bytes.resize(*rc::gen::inRange<std::size_t>(0, bytes.size()));
  RC_ASSERT(refused(bytes));
}

RC_GTEST_PROP(BrickCodec, WhatIsAcceptedIsWrittenAgainAsTheSameBytes, ()) {
  Bytes bytes = encoded(*arbitrary_brick());
  bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] ^= *rc::gen::nonZero<std::uint8_t>();
  ByteSpan in = bytes;
  const Result<Brick> read = read_brick(in);
  if (!read) return;
  RC_ASSERT(encoded(*read) == Bytes(bytes.begin(), bytes.end() - static_cast<std::ptrdiff_t>(in.size())));
}

TEST(BrickCodec, TakesTheFormThatIsShortest) {
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  VoxelMask one{};
  one[3] = 4;
  EXPECT_EQ(encoded(Brick()).size(), 1u);
  EXPECT_EQ(encoded(Brick::uniform(all, kFree)).size(), 3u);
  EXPECT_EQ(encoded(Brick::uniform(one, kFree)).size(), 1u + 8 + 1 + 2);
  EXPECT_EQ(encoded(striped(512, 2)).size(), 1u + 4 + 64);
  EXPECT_EQ(encoded(striped(2, 2)).size(), 1u + 8 + 1 + 4) << "two values are shorter raw";
  EXPECT_EQ(encoded(striped(512, 5)).size(), 1u + 1 + 10 + 512 * 3 / 8);
  EXPECT_EQ(encoded(striped(512, 256)).size(), 1u + 2 * 512) << "a palette of 256 is longer than raw values";
  EXPECT_EQ(encoded(striped(511, 511)).size(), kMaxBrickBytes);
}

TEST(BrickCodec, BytesAreAsDocumented) {
  DenseBrick dense;
  dense.fill(kUnknown);
  dense[0] = kOccupied;
  dense[1] = kFree;
  dense[511] = kOccupied;
  const Bytes expected{2 | 1 << 3, 1,    0,    0,    0,    0,
                       0,          0,    0x80,                    // pair, sparse: the first and the last mask byte
                       0x03,       0x80, 0x00, 0xf8, 0x00, 0x0e,  // the masks, -2048, 3584
                       0x05};                                     // occupied, free, occupied
  EXPECT_EQ(encoded(Brick::from_dense(dense)), expected);
}

TEST(BrickCodec, RefusesWhatNoBrickIsWrittenAs) {
  EXPECT_TRUE(refused({5})) << "unknown form of values";
  EXPECT_TRUE(refused({1 | 3 << 3, 0, 0})) << "unknown form of mask";
  EXPECT_TRUE(refused({1 | 1 << 5, 0, 0})) << "unknown flag";
  EXPECT_TRUE(refused({0 | 1 << 3})) << "empty with a mask";
  EXPECT_TRUE(refused({1, 0x00, 0x80})) << "the value 'unknown'";
  EXPECT_TRUE(refused({1 | 1 << 3, 0, 0, 0, 0, 0, 0, 0, 0, 7, 0})) << "no voxel known";
  EXPECT_TRUE(refused({1 | 1 << 3, 3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 7, 0})) << "a zero byte in a sparse mask";
  Bytes descending = encoded(striped(512, 2));
  std::swap_ranges(descending.begin() + 1, descending.begin() + 3, descending.begin() + 3);
  EXPECT_TRUE(refused(descending));
  Bytes padded = encoded(striped(3, 2));
  padded.back() |= 0x80;
  EXPECT_TRUE(refused(padded));
}

}  // namespace
}  // namespace concord
