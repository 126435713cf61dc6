#include "core/octomap_reader.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>

#include "arbitrary.hpp"
#include "core/octomap_writer.hpp"
#include "stock_octomap.hpp"

namespace concord {
namespace {

using namespace test;

Code refusal(const Bytes& bytes, OctomapFormat format, const OctomapLimits& limits = {}) {
  const auto read = read_octomap_data(bytes, format, 0.1, std::nullopt, limits);
  EXPECT_FALSE(read.has_value());
  return read ? Code::kIo : read.error().code;
}

void append_full_node(Bytes& out, float value, std::uint8_t children) {
  append_le(out, std::bit_cast<std::uint32_t>(value));
  out.push_back(children);
}

/// A binary tree of `depth` inner nodes, each the first child of the one before; the last one has a free first child.
Bytes binary_chain(int depth) {
  Bytes bytes;
  for (int i = 1; i < depth; ++i) append_le(bytes, std::uint16_t{3});
  append_le(bytes, std::uint16_t{1});
  return bytes;
}

TEST(OctomapReader, RealMapsHoldExactlyTheVoxelsOfStockOctomap) {
  const auto files = real_map_files();
  if (files.empty()) GTEST_SKIP() << "the shared maps are not there; set CONCORD_DATA";
  for (const std::string& path : files) {
    const Bytes bytes = file_bytes(path);
    const auto tree = stock_read(bytes);
    ASSERT_NE(tree, nullptr) << path;
    const auto read = read_octomap_file(bytes, std::nullopt);
    ASSERT_TRUE(read.has_value()) << path << ": " << read.error().message;
    EXPECT_EQ(read->resolution, tree->getResolution()) << path;
    EXPECT_GT(read->map.known_count(), 100'000u) << path;
    EXPECT_TRUE(read->map == expanded(*tree, StockValues::kStates)) << path;
  }
}

RC_GTEST_PROP(OctomapReader, ReadsWhatStockOctomapWrites, (unsigned seed)) {
  octomap::OcTree tree = scanned_tree(0.1, seed);
  const auto full = read_octomap_file(stock_file(tree, OctomapFormat::kFull), std::nullopt);
  RC_ASSERT(full.has_value());
  RC_ASSERT(full->map == expanded(tree, StockValues::kLogOdds));
  const auto binary = read_octomap_file(stock_file(tree, OctomapFormat::kBinary), 0.1);
  RC_ASSERT(binary.has_value());
  RC_ASSERT(binary->map == expanded(tree, StockValues::kStates));
  for (const auto format : {OctomapFormat::kBinary, OctomapFormat::kFull}) {
    const auto data = read_octomap_data(stock_data(tree, format), format, 0.1, std::nullopt);
    RC_ASSERT(data.has_value());
    RC_ASSERT(data->map == (format == OctomapFormat::kBinary ? binary->map : full->map));
  }
}

TEST(OctomapReader, PrunedLeavesCoverTheirCubes) {
  octomap::OcTree tree(0.1);
  for (int x = -16; x < 16; ++x) {
    for (int y = -16; y < 16; ++y) {
      for (int z = -16; z < 16; ++z) tree.updateNode(octomap::OcTreeKey(32768 + x, 32768 + y, 32768 + z), x < 0);
    }
  }
  tree.prune();
  ASSERT_EQ(tree.getNumLeafNodes(), 8u);
  const auto read = read_octomap_file(stock_file(tree, OctomapFormat::kBinary), std::nullopt);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->map.known_count(), 32u * 32 * 32);
  EXPECT_EQ(read->map.occupied_count(), 32u * 32 * 16);
  EXPECT_EQ(read->map.at({-1, 15, -16}), kOccupied);
  EXPECT_EQ(read->map.at({0, 15, -16}), kFree);
}

TEST(OctomapReader, NoBytesAreAnEmptyMap) {
  EXPECT_TRUE(read_octomap_data({}, OctomapFormat::kBinary, 0.1, std::nullopt)->map.empty());
  const auto file = read_octomap_file(stock_file(octomap::OcTree(0.1), OctomapFormat::kFull), std::nullopt);
  ASSERT_TRUE(file.has_value());
  EXPECT_TRUE(file->map.empty());
}

TEST(OctomapReader, ReadsAtTheResolutionThatIsAskedFor) {
  BrickMap map;
  DenseBrick dense;
  dense.fill(kUnknown);
  dense[0] = kFree;
  dense[1] = kOccupied;
  map.set({0, 0, 0}, Brick::from_dense(dense));
  const Bytes bytes = *write_octomap_data(map, OctomapFormat::kBinary);
  const auto coarse = read_octomap_data(bytes, OctomapFormat::kBinary, 0.05, 0.1);
  ASSERT_TRUE(coarse.has_value());
  EXPECT_EQ(coarse->resolution, 0.1);
  EXPECT_EQ(coarse->map.known_count(), 1u);
  EXPECT_EQ(coarse->map.at({0, 0, 0}), kOccupied) << "the largest of the contained";
  const auto fine = read_octomap_data(bytes, OctomapFormat::kBinary, 0.05, 0.025);
  ASSERT_TRUE(fine.has_value());
  EXPECT_EQ(fine->map.known_count(), 16u);
}

RC_GTEST_PROP(OctomapReader, EveryProperPrefixAndEveryExtraByteIsRefused, ()) {
  const auto format = *rc::gen::element(OctomapFormat::kBinary, OctomapFormat::kFull);
  const BrickMap map = *rc::gen::suchThat(arbitrary_map(4096), [](const BrickMap& m) { return !m.empty(); });
  Bytes bytes = *write_octomap_file(map, 0.05, format);
  bytes.push_back(0);
  RC_ASSERT(!read_octomap_file(bytes, std::nullopt).has_value());
  bytes.resize(*rc::gen::inRange<std::size_t>(0, bytes.size() - 1));
  RC_ASSERT(!read_octomap_file(bytes, std::nullopt).has_value());
}

RC_GTEST_PROP(OctomapReader, AnyBytesAreReadOrRefusedWithinTheLimits, (Bytes bytes)) {
  const auto format = *rc::gen::element(OctomapFormat::kBinary, OctomapFormat::kFull);
  const OctomapLimits limits{.known_voxels = 100'000, .bricks = 1'000};
  const auto read = read_octomap_data(bytes, format, 0.1, std::nullopt, limits);
  if (read) {
    RC_ASSERT(read->map.known_count() <= limits.known_voxels);
    RC_ASSERT(read->map.brick_count() <= limits.bricks);
  }
}

TEST(OctomapReader, RefusesTreesThatOctomapCannotHold) {
  EXPECT_EQ(refusal({0, 0}, OctomapFormat::kBinary), Code::kMalformed) << "an inner node without children";
  EXPECT_TRUE(read_octomap_data(binary_chain(16), OctomapFormat::kBinary, 0.1, std::nullopt).has_value());
  EXPECT_EQ(refusal(binary_chain(17), OctomapFormat::kBinary), Code::kMalformed) << "too deep";
  EXPECT_EQ(refusal(Bytes(1'000'000, 0xff), OctomapFormat::kBinary), Code::kMalformed) << "deeper still";
  Bytes deep;
  for (int i = 0; i < 17; ++i) append_full_node(deep, 1.0f, 1);
  append_full_node(deep, 1.0f, 0);
  EXPECT_EQ(refusal(deep, OctomapFormat::kFull), Code::kMalformed);
}

TEST(OctomapReader, RefusesValuesThatAreNoNumbers) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity()}) {
    for (const int bad_level : {0, 16}) {
      Bytes bytes;
      for (int i = 0; i < 16; ++i) append_full_node(bytes, i == bad_level ? bad : 1.0f, 1);
      append_full_node(bytes, bad_level == 16 ? bad : 1.0f, 0);
      EXPECT_EQ(refusal(bytes, OctomapFormat::kFull), Code::kNotFinite);
    }
  }
}

TEST(OctomapReader, RefusesMoreThanTheLimitsBeforeBuildingIt) {
  EXPECT_EQ(refusal({1, 0}, OctomapFormat::kBinary), Code::kTooLarge) << "a leaf of 2^45 voxels in two bytes";
  Bytes root;
  append_full_node(root, 1.0f, 0);
  EXPECT_EQ(refusal(root, OctomapFormat::kFull), Code::kTooLarge) << "the whole space as one leaf";
  EXPECT_EQ(refusal(binary_chain(8), OctomapFormat::kBinary, {.known_voxels = (1u << 24) - 1}), Code::kTooLarge);
  EXPECT_EQ(refusal(binary_chain(8), OctomapFormat::kBinary, {.bricks = (1u << 15) - 1}), Code::kTooLarge);
  EXPECT_EQ(refusal(binary_chain(16), OctomapFormat::kBinary, {.bytes = 31}), Code::kTooLarge);
  const auto finer = read_octomap_data(binary_chain(8), OctomapFormat::kBinary, 0.1, 0.001);
  ASSERT_FALSE(finer.has_value());
  EXPECT_EQ(finer.error().code, Code::kOutOfBounds) << "the corner of the space is 3 km away";
}

TEST(OctomapReader, RefusesAnotherNumberOfNodesThanTheHeaderSays) {
  const Bytes tree = binary_chain(16);
  for (const std::uint64_t nodes : {0, 16, 17, 18}) {
    Bytes file;
    append_octomap_header(file, {OctomapFormat::kBinary, nodes, 0.1});
    file.insert(file.end(), tree.begin(), tree.end());
    EXPECT_EQ(read_octomap_file(file, std::nullopt).has_value(), nodes == 17) << nodes;
  }
}

}  // namespace
}  // namespace concord
