#include "merge/map_store.hpp"

#include <cstdlib>

#include <gtest/gtest.h>

#include "store/whole_file.hpp"

namespace concord {
namespace {

class MapStoreTest : public ::testing::Test {
 protected:
  MapStoreTest() {
    std::string pattern = (std::filesystem::temp_directory_path() / "concord-maps-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  ~MapStoreTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
  Bytes bytes_{1, 2, 3};
};

TEST_F(MapStoreTest, SavesWhatReadsBackTheSame) {
  const MapStore maps(folder_ / "maps");
  ASSERT_TRUE(maps.save("hall", {{"bt", bytes_}}));
  ASSERT_TRUE(maps.save("hall", {{"concord", bytes_}}));
  const auto files = maps.list();
  ASSERT_TRUE(files);
  const auto size = static_cast<std::int64_t>(bytes_.size());
  EXPECT_EQ(*files, (std::vector<std::pair<std::string, std::int64_t>>{{"hall.bt", size}, {"hall.concord", size}}));
  EXPECT_EQ(*maps.read("hall", "bt", 100), bytes_);
  EXPECT_EQ(maps.read("hall", "bt", 2).error().code, Code::kTooLarge);
  EXPECT_EQ(maps.read("wall", "bt", 100).error().code, Code::kNotFound);
}

TEST_F(MapStoreTest, OverwritesOnlyWhenAsked) {
  const MapStore maps(folder_);
  EXPECT_TRUE(maps.check("hall", "bt", false));
  ASSERT_TRUE(maps.save("hall", {{"bt", bytes_}}));
  EXPECT_EQ(maps.check("hall", "bt", false).error().code, Code::kExists);
  EXPECT_TRUE(maps.check("hall", "ot", false));
  EXPECT_TRUE(maps.check("hall", "bt", true));
}

TEST_F(MapStoreTest, SavesAllFormatsOrNone) {
  const MapStore maps(folder_);
  ASSERT_TRUE(maps.save("hall", {{"bt", bytes_}}));
  std::filesystem::create_directory(folder_ / "hall.ot.part");  // so that the second cannot be written
  const auto saved = maps.save("hall", {{"bt", {4}}, {"ot", {5}}});
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().code, Code::kIo);
  EXPECT_EQ(*maps.read("hall", "bt", 100), bytes_);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "hall.bt.part"));
}

TEST_F(MapStoreTest, WhatIsNoFileIsNotReplaced) {
  std::filesystem::create_directory(folder_ / "hall.bt");
  EXPECT_EQ(MapStore(folder_).check("hall", "bt", true).error().code, Code::kIo);
}

TEST_F(MapStoreTest, AFolderThatIsNotThereHasNoMaps) {
  const auto files = MapStore(folder_ / "nowhere").list();
  ASSERT_TRUE(files);
  EXPECT_TRUE(files->empty());
}

TEST_F(MapStoreTest, SaysWhyItCannotSave) {
  ASSERT_TRUE(write_whole_file(folder_ / "file", {}));
  const auto saved = MapStore(folder_ / "file").save("hall", {{"bt", bytes_}});
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().code, Code::kIo);
}

}  // namespace
}  // namespace concord
