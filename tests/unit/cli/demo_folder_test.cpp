#include "cli/demo_folder.hpp"

#include <unistd.h>

#include <fstream>

#include <gtest/gtest.h>

namespace concord {
namespace {

namespace fs = std::filesystem;

class DemoFolderTest : public testing::Test {
 protected:
  void TearDown() override { fs::remove_all(folder.path); }

  void put(const std::string& name) const {
    fs::create_directories((folder.path / name).parent_path());
    std::ofstream(folder.path / name) << "of a person";
  }
  [[nodiscard]] bool has(const std::string& name) const { return fs::exists(folder.path / name); }

  DemoFolder folder{fs::path(testing::TempDir()) / ("demo_folder" + std::to_string(getpid()))};
};

TEST_F(DemoFolderTest, ReplacesWhatAnEarlierDemoWroteAndNothingElse) {
  ASSERT_TRUE(folder.prepare({}));
  for (const char* name : {"map.bt", "index.html", "demo_output/merge.txt", "notes.txt", "output/mine.txt"}) put(name);
  ASSERT_TRUE(folder.prepare({}));
  EXPECT_FALSE(has("map.bt"));
  EXPECT_FALSE(has("demo_output/merge.txt"));
  EXPECT_TRUE(has("notes.txt"));
  EXPECT_TRUE(has("output/mine.txt"));
}

TEST_F(DemoFolderTest, LeavesADemoThatRunsThereAlone) {
  {
    const auto runs = folder.prepare({});
    ASSERT_TRUE(runs);
    put("demo.lcm");
    const auto second = folder.prepare({});
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Code::kBusy);
    EXPECT_NE(second.error().message.find("a demo runs in " + folder.path.string()), std::string::npos);
    EXPECT_TRUE(has("demo.lcm"));
  }
  EXPECT_TRUE(folder.prepare({}));
  EXPECT_FALSE(has("demo.lcm"));
}

TEST_F(DemoFolderTest, NamesTheFolderThatItCannotWrite) {
  const auto prepared = DemoFolder{"/proc/nonexist"}.prepare({});
  ASSERT_FALSE(prepared);
  EXPECT_NE(prepared.error().message.find("/proc/nonexist:"), std::string::npos) << prepared.error().message;
}

TEST_F(DemoFolderTest, RefusesFilesThatNoDemoWrote) {
  put("map.bt");
  put("demo.lcm");
  const auto prepared = folder.prepare({});
  ASSERT_FALSE(prepared);
  EXPECT_EQ(prepared.error().code, Code::kExists);
  EXPECT_TRUE(has("map.bt"));
  EXPECT_TRUE(has("demo.lcm"));
}

TEST_F(DemoFolderTest, RefusesAnInputThatItWouldWriteOver) {
  ASSERT_TRUE(folder.prepare({}));
  put("map.bt");
  put("demo_state/maps/demo.bt");
  for (const char* input : {"map.bt", "demo_state/maps/demo.bt", "demo_state/../map.bt"}) {
    const auto prepared = folder.prepare({folder.path / input});
    ASSERT_FALSE(prepared) << input;
    EXPECT_EQ(prepared.error().code, Code::kBadRequest);
  }
  EXPECT_TRUE(has("map.bt"));
  EXPECT_TRUE(folder.prepare({folder.path / "map.bt2"}));
}

}  // namespace
}  // namespace concord
