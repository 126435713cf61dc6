#include "semantic/semantic_store.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "bus/site.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

class SemanticStoreTest : public testing::Test {
 protected:
  SemanticStoreTest() : file_(fs::path(testing::TempDir()) / ("semantic-" + std::to_string(getpid()) + ".db")) {
    clear();
  }
  ~SemanticStoreTest() override { clear(); }
  void clear() {
    for (const char* end : {"", "-wal", "-shm"}) fs::remove(file_.string() + end);
  }
  static LabelCorrection claim(std::int64_t revision) {
    return {revision,
            "l" + std::to_string(revision),
            "eva",
            5,
            99,
            LabelCorrection::Claim{
                {1, static_cast<std::uint32_t>(revision)}, revision == 1 ? "chair" : "", {{-3, 0, 2}, {-2, 0, 2}}, ""}};
  }
  std::vector<LabelCorrection> all() {
    std::vector<LabelCorrection> out;
    SemanticStore store(file_, 0.05);
    EXPECT_TRUE(store.for_each([&](LabelCorrection one) -> Result<void> {
      out.push_back(std::move(one));
      return {};
    }));
    return out;
  }

  fs::path file_;
};

TEST_F(SemanticStoreTest, GivesBackEachKind) {
  {
    SemanticStore store(file_, 0.05);
    ASSERT_TRUE(store.put(claim(1)));
    ASSERT_TRUE(store.put({2, "a", "eva", 5, ~std::uint64_t{0}, LabelCorrection::Rename{1, "stool"}}));
    ASSERT_TRUE(store.put({3, "b", "eva", 5, 1, LabelCorrection::Reassign{{1, 1}, {2, 4'000'000'000U}}}));
    ASSERT_TRUE(store.put({4, "c", "eva", 5, 1, LabelCorrection::TakeOff{{1, 0}}}));
    ASSERT_TRUE(store.put({5, "d", "eva", 5, 1, LabelCorrection::Undo{"c", false}}));
    EXPECT_FALSE(store.put({6, "d", "eva", 5, 1, LabelCorrection::Undo{"c", true}}));  // an id twice
  }
  const auto read = all();
  ASSERT_EQ(read.size(), 5U);
  const auto& first = std::get<LabelCorrection::Claim>(read[0].what);
  EXPECT_EQ(first.class_name, "chair");
  EXPECT_EQ(first.voxels, (std::vector<VoxelIndex>{{-3, 0, 2}, {-2, 0, 2}}));
  EXPECT_EQ(read[1].content, ~std::uint64_t{0});
  EXPECT_EQ(std::get<LabelCorrection::Rename>(read[1].what).name, "stool");
  EXPECT_EQ(std::get<LabelCorrection::Reassign>(read[2].what).to.instance, 4'000'000'000U);
  EXPECT_EQ(std::get<LabelCorrection::TakeOff>(read[3].what).of, (InstanceId{1, 0}));
  EXPECT_FALSE(std::get<LabelCorrection::Undo>(read[4].what).redo);
}

TEST_F(SemanticStoreTest, WhatWasStoredOutlivesAKillAtAnyMoment) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    SemanticStore store(file_, 0.05);
    for (std::int64_t revision = 1;; ++revision) {
      if (!store.put(claim(revision))) _exit(1);
      if (write(ends[1], &revision, sizeof(revision)) != sizeof(revision)) _exit(2);
    }
  }
  close(ends[1]);
  std::int64_t answered = 0;
  while (answered < 50) ASSERT_EQ(read(ends[0], &answered, sizeof(answered)), static_cast<ssize_t>(sizeof(answered)));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  for (std::int64_t more = 0; read(ends[0], &more, sizeof(more)) == sizeof(more);) answered = more;
  close(ends[0]);
  const auto read_back = all();
  ASSERT_GE(static_cast<std::int64_t>(read_back.size()), answered);
  for (std::size_t i = 0; i < read_back.size(); ++i) EXPECT_EQ(read_back[i].revision, static_cast<std::int64_t>(i) + 1);
}

TEST_F(SemanticStoreTest, RefusesAnotherResolutionAndSaysWhatIsDamaged) {
  { ASSERT_TRUE(SemanticStore(file_, 0.05).put(claim(1))); }
  EXPECT_THROW(SemanticStore(file_, 0.1), ConfigError);
  sqlite3* raw = nullptr;
  ASSERT_EQ(sqlite3_open(file_.c_str(), &raw), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(raw, "UPDATE corrections SET correction = x'0102'", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(raw);
  SemanticStore store(file_, 0.05);
  EXPECT_EQ(store.for_each([](const LabelCorrection&) -> Result<void> { return {}; }).error().code, Code::kIo);
}

}  // namespace
}  // namespace concord
