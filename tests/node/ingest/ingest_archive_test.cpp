#include <fstream>

#include "core/map_archive.hpp"
#include "station.hpp"
#include "store/whole_file.hpp"

namespace concord::testing {
namespace {

class IngestArchiveTest : public IngestStation {
 protected:
  struct Layer {
    std::string agent, frame_id;
    BrickMap bricks;
  };

  Bytes archive_of(const std::vector<Layer>& layers, double resolution) const {
    MapArchiveWriter writer(resolution);
    for (const Layer& layer : layers) {
      EXPECT_TRUE(writer.add({layer.agent, "robot", layer.frame_id, 17, 1}, layer.bricks));
    }
    return std::move(writer).finish().value();
  }
  Bytes save(const std::vector<Layer>& layers) {
    const Bytes bytes = archive_of(layers, site_.resolution);
    put_file("hall.concord", bytes);
    return bytes;
  }
  void put_file(const std::string& name, const Bytes& bytes) {
    std::filesystem::create_directories(site_.state / "maps");
    std::ofstream(site_.state / "maps" / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  Answer load(const std::string& id, const std::string& format = "concord", const std::string& agent = "") {
    MapRequest request{id, MapRequest::Op::kLoad, "hall", {}, false, agent};
    if (!format.empty()) request.formats = {format};
    start_->answers[id].clear();
    start_->say_at("in/map_request", request);
    if (const Answer& answer = start_->answers[id].back(); answer.code != "BUSY") return answer;
    return merge_says({id, "merge", false, "BUSY", "", incarnation_for(id), 0});
  }
  std::int64_t incarnation_for(const std::string& id) const {
    const auto bytes = read_whole_file(site_.state / "maps/hall.concord", 10'000'000);
    return bytes ? loaded_incarnation(*bytes, id) : kLoadedIncarnation;
  }
  /// What ingest answers after it.
  Answer merge_says(const Answer& word) {
    start_->say_at("out/answer", word);
    start_->run(0.5);
    return start_->answers[word.id].back();
  }
  /// Neither now nor after a restart is anybody there.
  void expect_nothing_changed() {
    for (int i = 0; i < 2; ++i) {
      start_->run(1);
      EXPECT_EQ(start_->counters.get("agents"), 0);
      restart();
    }
  }

  const std::vector<Layer> two_ = {{"robot1", "boot-1", some_map(40, 1)}, {"robot2", "boot-9", some_map(30, 2)}};
};

TEST_F(IngestArchiveTest, every_layer_is_an_agent_of_its_id_in_its_frame) {
  const Bytes file = save(two_);
  const Answer answer = load("q1");
  EXPECT_TRUE(answer.ok) << answer.message;
  EXPECT_EQ(answer.count, static_cast<std::int64_t>(two_[0].bricks.known_count() + two_[1].bricks.known_count()));
  for (int i = 0; i < 2; ++i) {
    start_->run(1);
    for (const auto& [agent, frame_id, bricks] : two_) {
      EXPECT_EQ(start_->follower[agent].map, bricks);
      EXPECT_EQ(start_->follower[agent].frame_id, frame_id);
      EXPECT_EQ(start_->follower[agent].receiver->incarnation(), loaded_incarnation(file, "q1"));
    }
    restart();
  }
}

TEST_F(IngestArchiveTest, nothing_is_loaded_before_merge_says_that_this_very_file_may_be) {
  const Bytes file = save(two_);
  const MapRequest request{"q1", MapRequest::Op::kLoad, "hall", {"concord"}, false, ""};
  EXPECT_EQ(start_->ask(request).code, "BUSY");
  merge_says({"q1", "merge", false, "BUSY", "starts", 0, 0});
  merge_says({"q1", "planner", false, "BUSY", "", incarnation_for("q1"), 0});
  merge_says({"other", "merge", false, "BUSY", "", incarnation_for("q1"), 0});
  expect_nothing_changed();
  EXPECT_EQ(start_->ask(request).code, "BUSY");
  merge_says({"q1", "merge", false, "BUSY", "", incarnation_for("q1") - 1, 0});
  expect_nothing_changed();
  EXPECT_EQ(start_->ask(request).code, "BUSY");
  merge_says({"q1", "merge", false, "EXISTS", "a zone has this name", 0, 0});
  merge_says({"q1", "merge", false, "BUSY", "", incarnation_for("q1"), 0});
  expect_nothing_changed();
  EXPECT_TRUE(load("q1").ok) << "asked again";
}

TEST_F(IngestArchiveTest, what_merge_has_whole_is_not_loaded_again) {
  save(two_);
  EXPECT_TRUE(load("q1").ok);
  restart();
  EXPECT_TRUE(start_->ask(AgentRequest{"r1", "robot1", AgentRequest::Op::kRemove}).ok);
  EXPECT_EQ(start_->ask(MapRequest{"q1", MapRequest::Op::kLoad, "hall", {"concord"}, false, ""}).code, "BUSY");
  EXPECT_TRUE(merge_says({"q1", "merge", true, "OK", "", 7, 0}).ok);
  start_->run(1);
  EXPECT_EQ(start_->counters.get("agents"), 1);
}

TEST_F(IngestArchiveTest, without_a_format_the_native_file_comes_first) {
  const auto octomap = write_octomap_file(some_map(3), site_.resolution, OctomapFormat::kFull).value();
  put_file("hall.ot", octomap);
  save(two_);
  EXPECT_TRUE(load("q1", "").ok);
  EXPECT_EQ(start_->follower["robot2"].map, two_[1].bricks);
  EXPECT_TRUE(load("q2", "ot").ok);
  start_->run(0.5);
  EXPECT_EQ(start_->follower["hall"].map, some_map(3));
}

TEST_F(IngestArchiveTest, a_request_that_comes_twice_is_done_once) {
  save(two_);
  const Answer first = load("q1");
  EXPECT_TRUE(start_->ask(AgentRequest{"r1", "robot1", AgentRequest::Op::kRemove}).ok);
  const Answer second = load("q1");
  EXPECT_TRUE(second.ok);
  EXPECT_EQ(second.count, first.count);
  EXPECT_EQ(start_->counters.get("agents"), 1) << "what was removed since has not come again";
  EXPECT_TRUE(start_->follower["robot1"].map.empty());
}

TEST_F(IngestArchiveTest, a_request_whose_answer_was_lost_with_the_process_is_known_by_what_it_loaded) {
  save(two_);
  const Answer first = load("q1");
  restart();
  const Answer again = load("q1");
  EXPECT_TRUE(again.ok) << again.message;
  EXPECT_EQ(again.count, first.count);
  EXPECT_EQ(load("q2").code, "EXISTS");
}

TEST_F(IngestArchiveTest, an_agent_that_is_there_keeps_the_whole_file_out) {
  say_octomap("robot2", "f", some_map(5));
  save(two_);
  EXPECT_EQ(load("q1").code, "EXISTS");
  for (int i = 0; i < 2; ++i) {
    start_->run(1);
    EXPECT_EQ(start_->counters.get("agents"), 1);
    EXPECT_EQ(start_->follower["robot2"].map, some_map(5));
    EXPECT_TRUE(start_->follower["robot1"].map.empty());
    restart();
  }
  EXPECT_TRUE(start_->ask(AgentRequest{"r1", "robot2", AgentRequest::Op::kRemove}).ok);
  EXPECT_TRUE(load("q1").ok) << "what was refused may be asked again";
}

TEST_F(IngestArchiveTest, a_file_that_is_missing_or_damaged_changes_nothing) {
  EXPECT_EQ(load("q1").code, "NO_MAP");
  Bytes file = save(two_);
  file[file.size() / 2] ^= 1;
  put_file("hall.concord", file);
  EXPECT_EQ(load("q2").code, "MALFORMED");
  put_file("hall.concord", {});
  EXPECT_EQ(load("q3").code, "MALFORMED");
  file = archive_of(two_, site_.resolution);
  file.pop_back();
  put_file("hall.concord", file);
  EXPECT_EQ(load("q4").code, "MALFORMED");
  put_file("hall.concord", archive_of(two_, 2 * site_.resolution));
  EXPECT_EQ(load("q5").code, "RES_MISMATCH");
  expect_nothing_changed();
}

TEST_F(IngestArchiveTest, its_agents_cannot_be_called_otherwise) {
  save(two_);
  const Answer answer = load("q1", "concord", "other");
  EXPECT_EQ(answer.code, "BAD_REQUEST");
  EXPECT_NE(answer.message.find("names its agents"), std::string::npos) << answer.message;
  EXPECT_EQ(load("q2", "", "other").code, "BAD_REQUEST");
  expect_nothing_changed();
}

TEST_F(IngestArchiveTest, more_than_the_site_allows_are_refused_together) {
  site_.ingest.max_agents = 1;
  restart();
  save(two_);
  EXPECT_EQ(load("q1").code, "TOO_LARGE");
  site_.ingest.max_agents = 2;
  site_.ingest.max_known_voxels = static_cast<std::int64_t>(two_[0].bricks.known_count()) - 1;
  restart();
  EXPECT_EQ(load("q2").code, "TOO_LARGE");
  expect_nothing_changed();
}

TEST_F(IngestArchiveTest, a_disk_that_refuses_the_last_layer_keeps_the_first_one_out) {
  start_.reset();
  ASSERT_TRUE(Database(site_.state / "ingest.db", std::array{""})
                  .execute("CREATE TRIGGER full BEFORE INSERT ON agent WHEN new.id = 'robot2' "
                           "BEGIN SELECT RAISE(ABORT, 'no room'); END"));
  restart();
  save(two_);
  EXPECT_EQ(load("q1").code, "IO");
  expect_nothing_changed();
  say_octomap("robot3", "f", some_map(5));
  EXPECT_EQ(start_->follower["robot3"].map, some_map(5)) << "it goes on serving";
}

TEST_F(IngestArchiveTest, a_robot_that_is_still_in_the_frame_goes_on_in_it) {
  save(two_);
  EXPECT_TRUE(load("q1").ok);
  const std::int64_t incarnation = start_->follower["robot1"].receiver->incarnation();
  const Robot robot(*start_, "robot1", "boot-1", some_map(60, 1), site_.resolution);
  start_->run(3);
  EXPECT_EQ(start_->follower["robot1"].map, robot.map());
  EXPECT_EQ(start_->follower["robot1"].receiver->incarnation(), incarnation) << "it stays where people put it";
}

TEST_F(IngestArchiveTest, incarnations_of_loaded_agents_are_not_counted_on) {
  save(two_);
  EXPECT_TRUE(load("q1").ok);
  restart();
  say_octomap("robot3", "f", some_map(5));
  EXPECT_LT(start_->follower["robot3"].receiver->incarnation(), kLoadedIncarnation);
}

}  // namespace
}  // namespace concord::testing
