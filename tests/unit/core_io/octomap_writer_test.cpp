#include "core/octomap_writer.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "arbitrary.hpp"
#include "core/octomap_reader.hpp"
#include "stock_octomap.hpp"

namespace concord {
namespace {

using namespace test;

RC_GTEST_PROP(OctomapWriter, MapsComeBack, ()) {
  const BrickMap map = *arbitrary_map(4096);
  const auto full = read_octomap_file(*write_octomap_file(map, 0.05, OctomapFormat::kFull), std::nullopt);
  RC_ASSERT(full.has_value());
  RC_ASSERT(full->map == map);
  RC_ASSERT(full->resolution == 0.05);
  const auto binary = read_octomap_file(*write_octomap_file(map, 0.05, OctomapFormat::kBinary), std::nullopt);
  RC_ASSERT(binary.has_value());
  RC_ASSERT(binary->map == states_of(map));
}

RC_GTEST_PROP(OctomapWriter, StockOctomapReadsTheSameMap, ()) {
  const BrickMap map = *rc::gen::suchThat(arbitrary_map(4096), [](const BrickMap& m) { return !m.empty(); });
  const auto full = stock_read(*write_octomap_file(map, 0.1 / 3, OctomapFormat::kFull));
  RC_ASSERT(full != nullptr);
  RC_ASSERT(full->getResolution() == 0.1 / 3);
  RC_ASSERT(expanded(*full, StockValues::kLogOdds) == map);
  const auto binary = stock_read(*write_octomap_file(map, 0.1 / 3, OctomapFormat::kBinary));
  RC_ASSERT(binary != nullptr);
  RC_ASSERT(expanded(*binary, StockValues::kStates) == states_of(map));
}

RC_GTEST_PROP(OctomapWriter, WritesTheVeryBytesOfStockOctomap, (unsigned seed)) {
  octomap::OcTree tree = scanned_tree(0.1, seed);
  // Values that both sides hold exactly, so that the same voxels are equal to both.
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    leaf->setLogOdds(static_cast<float>(to_double(to_log_odds(leaf->getLogOdds()))));
  }
  tree.updateInnerOccupancy();
  tree.prune();
  const BrickMap map = expanded(tree, StockValues::kLogOdds);
  RC_ASSERT(*write_octomap_data(map, OctomapFormat::kFull) == stock_data(tree, OctomapFormat::kFull));
  tree.toMaxLikelihood();
  tree.prune();
  RC_ASSERT(*write_octomap_data(map, OctomapFormat::kBinary) == stock_data(tree, OctomapFormat::kBinary));
}

TEST(OctomapWriter, RealMapsAreWrittenAsStockOctomapWritesThem) {
  const auto files = real_map_files();
  if (files.empty()) GTEST_SKIP() << "the shared maps are not there; set CONCORD_DATA";
  for (const std::string& path : files) {
    const Bytes bytes = file_bytes(path);
    const auto tree = stock_read(bytes);
    ASSERT_NE(tree, nullptr) << path;
    tree->toMaxLikelihood();
    tree->prune();
    const auto read = read_octomap_file(bytes, std::nullopt);
    ASSERT_TRUE(read.has_value()) << path;
    EXPECT_TRUE(*write_octomap_data(read->map, OctomapFormat::kBinary) == stock_data(*tree, OctomapFormat::kBinary))
        << path;
  }
}

TEST(OctomapWriter, EightEqualBricksAreOneLeaf) {
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  BrickMap map;
  for (int i = 0; i < 64; ++i) map.set(brick_at(TileIndex{0, 0, 0}, i), Brick::uniform(all, 512));
  EXPECT_EQ(write_octomap_data(map, OctomapFormat::kBinary)->size(), 2u * 11) << "11 inner nodes above 32^3 voxels";
  EXPECT_EQ(write_octomap_data(map, OctomapFormat::kFull)->size(), 5u * 12);
}

TEST(OctomapWriter, AnEmptyMapIsAFileThatStockOctomapReads) {
  const Bytes file = *write_octomap_file({}, 0.05, OctomapFormat::kBinary);
  const auto tree = stock_read(file);
  ASSERT_NE(tree, nullptr);
  EXPECT_EQ(tree->size(), 0u);
  EXPECT_TRUE(write_octomap_data({}, OctomapFormat::kFull)->empty());
  EXPECT_TRUE(read_octomap_file(file, std::nullopt)->map.empty());
}

TEST(OctomapWriter, RefusesVoxelsBeyondOctomapsKeys) {
  VoxelMask one{1};
  for (const std::int32_t beyond : {-4097, 4096}) {
    BrickMap map;
    map.set({0, beyond, 0}, Brick::uniform(one, kFree));
    const auto bytes = write_octomap_data(map, OctomapFormat::kBinary);
    ASSERT_FALSE(bytes.has_value());
    EXPECT_EQ(bytes.error().code, Code::kOutOfBounds);
  }
  EXPECT_EQ(write_octomap_file({}, -1.0, OctomapFormat::kBinary).error().code, Code::kBadResolution);
}

}  // namespace
}  // namespace concord
