#include "merge/map_store.hpp"

#include <cstdlib>

#include <gtest/gtest.h>

#include "core/octomap_reader.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

class MapStoreTest : public ::testing::Test {
 protected:
  MapStoreTest() {
    std::string pattern = (std::filesystem::temp_directory_path() / "concord-maps-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    VoxelMask mask{};
    mask[3] = 0xF0;
    map_.set({1, -2, 3}, Brick::uniform(mask, kOccupied));
  }
  ~MapStoreTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
  BrickMap map_;
};

TEST_F(MapStoreTest, SavesWhatReadsBackTheSame) {
  const MapStore maps(folder_ / "maps");
  const auto bytes = maps.save(map_, 0.05, "hall", "bt", false);
  ASSERT_TRUE(bytes) << bytes.error().message;
  const auto files = maps.list();
  ASSERT_TRUE(files);
  EXPECT_EQ(*files, (std::vector<std::pair<std::string, std::int64_t>>{{"hall.bt", *bytes}}));
  const auto read = read_octomap_file(*read_whole_file(folder_ / "maps/hall.bt", 1000), std::nullopt);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->map, map_);
}

TEST_F(MapStoreTest, OverwritesOnlyWhenAsked) {
  const MapStore maps(folder_);
  ASSERT_TRUE(maps.save(map_, 0.05, "hall", "bt", false));
  const auto again = maps.save(BrickMap{}, 0.05, "hall", "bt", false);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, Code::kExists);
  EXPECT_TRUE(maps.save(BrickMap{}, 0.05, "hall", "bt", true));
}

TEST_F(MapStoreTest, AFolderThatIsNotThereHasNoMaps) {
  const auto files = MapStore(folder_ / "nowhere").list();
  ASSERT_TRUE(files);
  EXPECT_TRUE(files->empty());
}

TEST_F(MapStoreTest, SaysWhyItCannotSave) {
  ASSERT_TRUE(write_whole_file(folder_ / "file", {}));
  const auto saved = MapStore(folder_ / "file").save(map_, 0.05, "hall", "bt", false);
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().code, Code::kIo);
}

}  // namespace
}  // namespace concord
