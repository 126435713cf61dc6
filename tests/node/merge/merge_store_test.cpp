#include "merge/merge_store.hpp"

#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "core/correction_check.hpp"
#include "core/map_archive.hpp"
#include "merge/number_text.hpp"

namespace concord {
namespace {

Transform turned(double yaw, double x) {
  Transform T = Transform::Identity();
  T.linear() = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  T.translation() = Eigen::Vector3d(x, -2.0 / 3.0, 0.1);
  return T;
}

class MergeStoreTest : public ::testing::Test {
 protected:
  MergeStoreTest() {
    std::string pattern = (std::filesystem::temp_directory_path() / "concord-mergedb-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    file_ = folder_ / "merge.db";
  }
  ~MergeStoreTest() override { std::filesystem::remove_all(folder_); }

  /// As the sqlite3 shell does it.
  void run_sql(const std::string& sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &database), SQLITE_OK);
    char* error = nullptr;
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, &error), SQLITE_OK) << error;
    sqlite3_close(database);
  }
  std::vector<Correction> read() {
    MergeStore store(file_, 0.1);
    std::vector<Correction> all;
    const auto done = store.for_each([&](Correction correction) -> Result<void> {
      all.push_back(std::move(correction));
      return {};
    });
    EXPECT_TRUE(done) << done.error().message;
    return all;
  }

  std::filesystem::path folder_, file_;
};

TEST_F(MergeStoreTest, EveryCorrectionComesBackToTheBit) {
  Zone zone;
  zone.name = "Tür 7";
  zone.kind = Zone::Kind::kAllowContact;
  zone.T_map_zone = turned(0.7, 1.0 / 3.0);
  OrientedBox oriented{turned(-1.1, 0.2), {0.1, 0.2, 0.3}};
  Prism prism{{{0, 0}, {1.0 / 7.0, 0}, {0, 1e-3}}, -0.5, 2.25};
  const auto change = [&](Volume volume) {
    Zone with = zone;
    with.volume = std::move(volume);
    return Correction::ZoneChange{ZoneRequest::Op::kChange, with};
  };
  Zone gone;
  gone.name = zone.name;
  const std::vector<Correction> all{
      {1, "a", "eva", 10, ~std::uint64_t{0},
       Correction::Edit{EditRequest::Op::kMove, {{1, 2, 3}, {1, 2, 4}}, {{-7, 0, 9}}}},
      {2, "b", "", 11, 1, Correction::Undo{"a", false}},
      {3, "c", "tom", 12, 2, Correction::Undo{"a", true}},
      {4, "d", "tom", 13, 3, Correction::ZoneChange{ZoneRequest::Op::kAdd, change(Box{{0, 0, 0}, {1, 2, 0.1}}).zone}},
      {5, "e", "tom", 14, 4, change(oriented)},
      {6, "f", "tom", 15, 5, change(prism)},
      {7, "g", "tom", 16, 6, Correction::ZoneChange{ZoneRequest::Op::kDelete, gone}},
      {8, "h", "tom", 17, 7, Correction::Placement{"robot1", "odom", std::int64_t{1} << 62, true, turned(2, 5)}},
      {9, "i", "tom", 18, 8, Correction::Weight{"robot1", 1000}},
  };
  {
    MergeStore store(file_, 0.1);
    for (const Correction& correction : all) ASSERT_TRUE(store.put({&correction, 1}));
  }
  const std::vector<Correction> back = read();
  ASSERT_EQ(back.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(back[i].revision, all[i].revision);
    EXPECT_EQ(back[i].id, all[i].id);
    EXPECT_EQ(back[i].author, all[i].author);
    EXPECT_EQ(back[i].utime, all[i].utime);
    EXPECT_EQ(back[i].content, all[i].content);
    EXPECT_EQ(back[i].what.index(), all[i].what.index());
    EXPECT_EQ(summary(back[i], true).kind, summary(all[i], true).kind);
    EXPECT_EQ(summary(back[i], true).subject, summary(all[i], true).subject);
  }
  const auto& edit = std::get<Correction::Edit>(back[0].what);
  EXPECT_EQ(edit.added, (std::vector<VoxelIndex>{{1, 2, 3}, {1, 2, 4}}));
  EXPECT_EQ(edit.deleted, (std::vector<VoxelIndex>{{-7, 0, 9}}));
  for (const std::size_t i : {3, 4, 5}) {
    const Zone& was = std::get<Correction::ZoneChange>(all[i].what).zone;
    const Zone& is = std::get<Correction::ZoneChange>(back[i].what).zone;
    EXPECT_EQ(is.kind, was.kind);
    EXPECT_EQ(is.T_map_zone.matrix(), was.T_map_zone.matrix());
    EXPECT_EQ(to_text(is.volume), to_text(was.volume));
  }
  const auto& placement = std::get<Correction::Placement>(back[7].what);
  EXPECT_EQ(placement.T_map_agent.matrix(), turned(2, 5).matrix()) << "a map of it must be the same to the byte";
  EXPECT_EQ(placement.incarnation, std::int64_t{1} << 62);
  EXPECT_TRUE(placement.has_layer);
}

/// What the first release wrote, by its own SQL.
constexpr const char* kFirstVersion = R"sql(
CREATE TABLE site (resolution REAL NOT NULL);
CREATE TABLE transforms (agent TEXT NOT NULL, frame_id TEXT NOT NULL, incarnation INTEGER NOT NULL,
  has_layer INTEGER NOT NULL, author TEXT NOT NULL, utime INTEGER NOT NULL,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,
  qx REAL NOT NULL, qy REAL NOT NULL, qz REAL NOT NULL, qw REAL NOT NULL,
  PRIMARY KEY (agent, frame_id, incarnation));
CREATE TABLE edits (revision INTEGER PRIMARY KEY AUTOINCREMENT, edit_id TEXT NOT NULL UNIQUE, author TEXT NOT NULL,
  utime INTEGER NOT NULL, op INTEGER NOT NULL, boxes BLOB NOT NULL);
INSERT INTO site VALUES (0.1);
INSERT INTO transforms VALUES ('robot1', 'odom', 5, 1, 'eva', 300, 1.5, 2, 3, 0, 0, 0.6, 0.8);
INSERT INTO transforms VALUES ('robot2', 'odom', 0, 0, 'tom', 200, 0, 0, 0, 0.5, 0.5, 0.5, 0.5);
INSERT INTO edits (edit_id, author, utime, op, boxes)
  VALUES ('late', 'eva', 900, 1, x'000000000000000001000000' || x'000000000000000002000000');
INSERT INTO edits (edit_id, author, utime, op, boxes)
  VALUES ('early', 'tom', 100, 2, x'f9ffffff0000000001000000f9ffffff0000000001000000');
PRAGMA user_version = 1;
)sql";

TEST_F(MergeStoreTest, WhatTheFirstVersionKeptIsThereInItsOrder) {
  run_sql(kFirstVersion);
  for (const bool again : {false, true}) {
    SCOPED_TRACE(again);
    const std::vector<Correction> all = read();
    ASSERT_EQ(all.size(), 4u);
    EXPECT_EQ(all[0].revision, 1);
    EXPECT_EQ(all[0].id, "late");
    EXPECT_EQ(all[0].author, "eva");
    EXPECT_EQ(all[0].content, 0u);
    EXPECT_EQ(std::get<Correction::Edit>(all[0].what).added, (std::vector<VoxelIndex>{{0, 0, 1}, {0, 0, 2}}));
    EXPECT_EQ(all[1].revision, 2);
    EXPECT_EQ(all[1].id, "early") << "edits keep their order and revisions, whatever their clocks said";
    EXPECT_EQ(std::get<Correction::Edit>(all[1].what).deleted, (std::vector<VoxelIndex>{{-7, 0, 1}}));
    EXPECT_EQ(all[2].revision, 3);
    const auto& second = std::get<Correction::Placement>(all[2].what);
    EXPECT_EQ(second.agent, "robot2") << "transforms follow, in the order of time";
    EXPECT_FALSE(second.has_layer);
    const auto& first = std::get<Correction::Placement>(all[3].what);
    EXPECT_EQ(first.agent, "robot1");
    EXPECT_EQ(first.frame_id, "odom");
    EXPECT_EQ(first.incarnation, 5);
    EXPECT_EQ(all[3].utime, 300);
    const auto T = make_transform({1.5, 2, 3}, {0, 0, 0.6, 0.8});
    EXPECT_TRUE(first.T_map_agent.isApprox(*T, 1e-15));
    EXPECT_TRUE(second.T_map_agent.isApprox(*make_transform({0, 0, 0}, {0.5, 0.5, 0.5, 0.5}), 1e-15));
  }
}

TEST_F(MergeStoreTest, TheLargestEditOfTheFirstVersionAtAnyTimeCanBeSavedWithAMap) {
  run_sql(std::string(kFirstVersion) +
          "INSERT INTO edits VALUES (3, 'huge', 'eva', -5, 1, x'000000000000000000000000630000006300000063000000');");
  CorrectionCheck check;
  MapArchiveWriter writer(0.1);
  std::size_t most = 0;
  for (const Correction& correction : read()) {
    EXPECT_TRUE(check.take(correction)) << correction.id;
    EXPECT_TRUE(writer.add(correction)) << correction.id;
    const auto* edit = std::get_if<Correction::Edit>(&correction.what);
    if (edit != nullptr) most = std::max(most, edit->added.size());
  }
  EXPECT_EQ(most, 1'000'000u);
  EXPECT_TRUE(std::move(writer).finish());
}

TEST_F(MergeStoreTest, AnEmptyStoreOfTheFirstVersionIsBroughtUpToo) {
  std::string sql = kFirstVersion;
  for (auto at = sql.find("INSERT INTO transforms"); at != sql.npos; at = sql.find("INSERT INTO transforms")) {
    sql.erase(at, sql.find(';', at) + 1 - at);
  }
  for (auto at = sql.find("INSERT INTO edits"); at != sql.npos; at = sql.find("INSERT INTO edits")) {
    sql.erase(at, sql.find(';', at) + 1 - at);
  }
  run_sql(sql);
  EXPECT_TRUE(read().empty());
}

TEST_F(MergeStoreTest, WhatIsRefusedLeavesNoTraceAndNoGap) {
  MergeStore store(file_, 0.1);
  const auto weight = [](std::int64_t revision, const std::string& id) {
    return std::vector<Correction>{{revision, id, "eva", 1, 1, Correction::Weight{"robot1", 5}}};
  };
  ASSERT_TRUE(store.put(weight(1, "a")));
  const std::vector<Correction> taken{weight(2, "b")[0], weight(3, "a")[0]};
  EXPECT_EQ(store.put(taken).error().code, Code::kIo);
  ASSERT_TRUE(store.put(weight(2, "c"))) << "the same revision";
  int count = 0;
  ASSERT_TRUE(store.for_each([&](const Correction& correction) -> Result<void> {
    EXPECT_EQ(correction.revision, ++count);
    return {};
  }));
  EXPECT_EQ(count, 2);
}

TEST_F(MergeStoreTest, ADamagedRowIsToldNotGuessed) {
  for (const char* damage :
       {"DELETE FROM placements", "UPDATE corrections SET kind = 'dance'", "UPDATE placements SET rotation = '1 0 0'",
        "UPDATE placements SET rotation = '2 0 0 0 1 0 0 0 1'",
        "UPDATE placements SET rotation = 'nan 0 0 0 1 0 0 0 1'"}) {
    SCOPED_TRACE(damage);
    std::filesystem::remove_all(folder_);
    {
      MergeStore store(file_, 0.1);
      const Correction one{1, "a", "eva", 1, 1, Correction::Placement{"r", "f", 1, true, turned(1, 1)}};
      ASSERT_TRUE(store.put({&one, 1}));
    }
    run_sql(damage);
    MergeStore store(file_, 0.1);
    const auto done = store.for_each([](const Correction&) -> Result<void> { return {}; });
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, Code::kIo);
  }
}

TEST_F(MergeStoreTest, VolumesThatAreNoneAreNotRead) {
  for (const char* text : {"", "box", "box 0 0 0 1 1", "box 0 0 0 1 1 1 1", "box 0 0 0 1 1 1 ", "box 1 1 1 0 0 0",
                           "ball 0 0 0 1 1 1", "prism 0 1 0 0 1 1", "box 0 0 0 1 1 x", "prism 0 1 0 0 1 1 2"}) {
    EXPECT_FALSE(volume_from_text(text)) << text;
  }
  EXPECT_TRUE(volume_from_text("box 0 0 0 1 1 1"));
}

}  // namespace
}  // namespace concord
