#include <fstream>

#include "agent/cloud_publisher.hpp"
#include "agent/submap_publisher.hpp"
#include "core/downsample.hpp"
#include "station.hpp"

namespace concord::testing {
namespace {

class IngestRequestTest : public IngestStation {
 protected:
  void save_map(const std::string& file, const BrickMap& map, OctomapFormat format) {
    std::filesystem::create_directories(site_.state / "maps");
    const Bytes bytes = write_octomap_file(map, site_.resolution, format).value();
    std::ofstream(site_.state / "maps" / file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
};

TEST_F(IngestRequestTest, a_reset_drops_the_layer_and_waits_for_a_new_frame) {
  Robot robot(*start_, "robot1", "boot-1", some_map(50), site_.resolution);
  start_->run(1);
  const Answer answer = start_->ask(AgentRequest{"q1", "robot1", AgentRequest::Op::kReset});
  EXPECT_TRUE(answer.ok) << answer.message;
  EXPECT_EQ(answer.count, static_cast<std::int64_t>(robot.map().known_count()));
  EXPECT_TRUE(start_->follower["robot1"].map.empty());
  EXPECT_EQ(start_->follower["robot1"].frame_id, "boot-1");
  robot.set({0, 0, 0}, Brick::uniform({1}, kFree));
  start_->run(1);
  EXPECT_TRUE(start_->follower["robot1"].map.empty()) << "the robot goes on in the frame that is over";
  EXPECT_GT(start_->counters.get("refused.in/robot1/bricks.BAD_FRAME"), 0);
  robot.begin("boot-2");
  start_->run(1);
  EXPECT_EQ(start_->follower["robot1"].map, robot.map());
  EXPECT_EQ(start_->follower["robot1"].frame_id, "boot-2");
}

/// A bus that loses the first message that its stations would hear on `out/frame_over/...`.
class HardOfHearing final : public Bus {
 public:
  explicit HardOfHearing(Bus& air) : air_(air) {}
  using Bus::every, Bus::subscribe;
  void subscribe(const std::string& channel_regex, Handler handler, int queued, Owner owner) override {
    const auto hear = [this, handler](const std::string& channel, auto bytes) {
      if (!channel.starts_with("out/frame_over/") || said_over++ > 0) handler(channel, bytes);
    };
    air_.subscribe(channel_regex, hear, queued, std::move(owner));
  }
  void publish(const std::string& channel, std::span<const std::uint8_t> bytes) override {
    air_.publish(channel, bytes);
  }
  void every(std::int64_t period, Task task, Owner owner) override {
    air_.every(period, std::move(task), std::move(owner));
  }
  [[nodiscard]] std::int64_t now() const override { return air_.now(); }

  int said_over = 0;

 private:
  Bus& air_;
};

TEST_F(IngestRequestTest, a_robot_begins_anew_though_the_first_word_of_its_reset_was_lost) {
  HardOfHearing bus(start_->bus);
  int resets = 0;
  SubmapPublisher* self = nullptr;
  SubmapPublisher robot(bus, start_->counters, {"robot1", site_.resolution, 5e6, start_->bus.now()}, [&] {
    ++resets;
    self->begin_frame("boot-2");
    self->publish(some_map(20));
  });
  self = &robot;
  robot.begin_frame("boot-1");
  robot.publish(some_map(50));
  start_->run(1.5);
  EXPECT_TRUE(start_->ask(AgentRequest{"q1", "robot1", AgentRequest::Op::kReset}).ok);
  EXPECT_EQ(bus.said_over, 1);
  EXPECT_EQ(resets, 0);
  start_->run(3);
  EXPECT_EQ(resets, 1);
  EXPECT_EQ(start_->follower["robot1"].frame_id, "boot-2");
  EXPECT_EQ(start_->follower["robot1"].map, some_map(20));
  const int said = bus.said_over;
  start_->run(5);
  EXPECT_EQ(bus.said_over, said) << "it is over and done with";
}

TEST_F(IngestRequestTest, a_robot_that_was_off_at_its_reset_hears_of_it_when_it_is_back) {
  say_octomap("robot1", "f", some_map(50));
  EXPECT_TRUE(start_->ask(AgentRequest{"q1", "robot1", AgentRequest::Op::kReset}).ok);
  restart();
  int resets = 0;
  CloudPublisher robot(start_->bus, start_->counters, "robot1", 7, [&] { ++resets; });
  robot.begin_frame("f");
  for (int i = 0; i < 10; ++i) {
    robot.publish(Transform::Identity(), 0, {{1, 1, 1}}, start_->bus.now());
    start_->run(0.2);
  }
  EXPECT_EQ(resets, 1);
}

TEST_F(IngestRequestTest, a_reset_that_is_refused_reaches_no_robot) {
  int resets = 0;
  CloudPublisher robot(start_->bus, start_->counters, "robot1", 7, [&] { ++resets; });
  robot.begin_frame("f");
  EXPECT_FALSE(start_->ask(AgentRequest{"q1", "robot1", AgentRequest::Op::kReset}).ok);  // sent nothing so far
  EXPECT_EQ(resets, 0);
}

TEST_F(IngestRequestTest, a_reset_holds_after_a_restart) {
  say_octomap("robot1", "f", some_map(50));
  EXPECT_TRUE(start_->ask(AgentRequest{"q1", "robot1", AgentRequest::Op::kReset}).ok);
  restart();
  say_octomap("robot1", "f", some_map(50));
  EXPECT_EQ(start_->counters.get("refused.in/robot1/octomap.BAD_FRAME"), 1);
  EXPECT_TRUE(start_->follower["robot1"].map.empty());
  EXPECT_EQ(start_->follower["robot1"].frame_id, "f") << "the agent is still there";
  const Robot robot(*start_, "robot1", "f", some_map(50), site_.resolution);
  start_->run(1);
  EXPECT_TRUE(start_->follower["robot1"].map.empty());
}

TEST_F(IngestRequestTest, a_request_that_comes_twice_is_done_once_and_answered_alike) {
  say_octomap("robot1", "f", some_map(50));
  const AgentRequest request{"q1", "robot1", AgentRequest::Op::kReset};
  const Answer first = start_->ask(request);
  say_octomap("robot1", "g", some_map(10));
  const Answer second = start_->ask(request);
  EXPECT_EQ(start_->follower["robot1"].map, some_map(10));
  EXPECT_EQ(second.ok, first.ok);
  EXPECT_EQ(second.message, first.message);
  EXPECT_EQ(second.count, first.count);
}

TEST_F(IngestRequestTest, a_removed_agent_is_gone_for_all_who_listen_now_or_later) {
  say_octomap("robot1", "f", some_map(50));
  say_octomap("robot2", "f", some_map(5));
  EXPECT_TRUE(start_->ask(AgentRequest{"q1", "robot1", AgentRequest::Op::kRemove}).ok);
  start_->run(1);
  EXPECT_EQ(start_->follower["robot1"].ends, 1);
  EXPECT_TRUE(start_->follower["robot1"].map.empty());
  EXPECT_EQ(start_->counters.get("agents"), 1);
  restart();
  start_->run(1.5);
  EXPECT_GT(start_->follower["robot1"].receiver->heard(), 0);
  EXPECT_EQ(start_->follower["robot1"].frames, 0);
  EXPECT_EQ(start_->follower["robot2"].map, some_map(5));
}

TEST_F(IngestRequestTest, a_removed_robot_that_still_sends_is_a_new_agent) {
  Robot robot(*start_, "robot1", "boot-1", some_map(50), site_.resolution);
  start_->run(1);
  EXPECT_TRUE(start_->ask(AgentRequest{"q1", "robot1", AgentRequest::Op::kRemove}).ok);
  start_->run(3);
  EXPECT_EQ(start_->follower["robot1"].map, robot.map());
  EXPECT_EQ(start_->follower["robot1"].frames, 2);
  restart();
  start_->run(1);
  EXPECT_EQ(start_->follower["robot1"].map, robot.map());
}

TEST_F(IngestRequestTest, an_agent_stays_the_same_through_a_restart_but_not_through_a_removal) {
  const auto incarnation = [this] { return start_->follower["robot1"].receiver->incarnation(); };
  say_octomap("robot1", "f", some_map(5));
  const std::int64_t first = incarnation();
  start_->ask(AgentRequest{"q1", "robot1", AgentRequest::Op::kReset});
  restart();
  start_->run(1);
  EXPECT_EQ(incarnation(), first);
  start_->ask(AgentRequest{"q2", "robot1", AgentRequest::Op::kRemove});
  restart();
  say_octomap("robot1", "f", some_map(5));
  EXPECT_NE(incarnation(), first);
  const std::int64_t second = incarnation();
  start_->ask(AgentRequest{"q3", "robot1", AgentRequest::Op::kRemove});
  say_octomap("robot1", "f", some_map(5));
  EXPECT_NE(incarnation(), second);
}

TEST_F(IngestRequestTest, agents_can_come_and_go_many_times) {
  for (int i = 0; i < 100; ++i) {
    std::string id = "q";
    id += std::to_string(i);
    say_octomap("robot1", "f", some_map(3, i));
    EXPECT_EQ(start_->follower["robot1"].map, some_map(3, i));
    EXPECT_TRUE(start_->ask(AgentRequest{id, "robot1", AgentRequest::Op::kRemove}).ok);
  }
}

TEST_F(IngestRequestTest, unknown_agents_are_refused) {
  for (const auto op : {AgentRequest::Op::kReset, AgentRequest::Op::kRemove}) {
    const Answer answer = start_->ask(AgentRequest{op == AgentRequest::Op::kReset ? "q1" : "q2", "nobody", op});
    EXPECT_FALSE(answer.ok);
    EXPECT_EQ(answer.code, "NO_AGENT");
    EXPECT_EQ(answer.process, "ingest");
  }
}

TEST_F(IngestRequestTest, a_saved_map_becomes_an_agent_that_stays) {
  save_map("hall.ot", some_map(40), OctomapFormat::kFull);
  MapRequest request{"q1", MapRequest::Op::kLoad, "hall", {}, false, ""};
  const Answer answer = start_->ask(request);
  EXPECT_TRUE(answer.ok) << answer.message;
  EXPECT_EQ(answer.message, "loaded; agent hall waits to be aligned");
  EXPECT_EQ(answer.count, static_cast<std::int64_t>(some_map(40).known_count()));
  EXPECT_EQ(start_->follower["hall"].map, some_map(40));
  EXPECT_EQ(start_->follower["hall"].frame_id, "map-hall");
  request.id = "q2";
  EXPECT_EQ(start_->ask(request).code, "EXISTS");
  request.id = "q3";
  request.agent = "second";
  EXPECT_TRUE(start_->ask(request).ok);
  restart();
  start_->run(1);
  EXPECT_EQ(start_->follower["hall"].map, some_map(40));
  EXPECT_EQ(start_->follower["second"].map, some_map(40));
}

TEST_F(IngestRequestTest, maps_that_are_not_there_or_damaged_change_nothing) {
  MapRequest request{"q1", MapRequest::Op::kLoad, "hall", {"bt"}, false, ""};
  EXPECT_EQ(start_->ask(request).code, "NO_MAP");
  save_map("hall.bt", some_map(40), OctomapFormat::kBinary);
  std::filesystem::resize_file(site_.state / "maps/hall.bt",
                               std::filesystem::file_size(site_.state / "maps/hall.bt") - 1);
  request.id = "q2";
  EXPECT_EQ(start_->ask(request).code, "MALFORMED");
  start_->run(1);
  EXPECT_EQ(start_->counters.get("agents"), 0);
  restart();
  start_->run(1);
  EXPECT_EQ(start_->counters.get("agents"), 0);
}

TEST_F(IngestRequestTest, saving_and_listing_are_left_to_merge) {
  for (const auto op : {MapRequest::Op::kSave, MapRequest::Op::kList}) {
    start_->bus.publish("in/map_request", encode(MapRequest{"q1", op, "hall", {"bt"}, false, ""}, 1));
  }
  start_->run(1);
  EXPECT_TRUE(start_->answers["q1"].empty());
}

TEST_F(IngestRequestTest, a_coarse_view_comes_in_parts_that_fit_a_frame) {
  const BrickMap map = some_map(400);
  say_octomap("robot1", "f", map);
  const Answer answer = start_->ask(DownsampleRequest{"q1", "robot1", 0.5});
  EXPECT_TRUE(answer.ok) << answer.message;
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < start_->parts.size(); ++i) {
    const Downsampled& part = start_->parts[i];
    EXPECT_EQ(part.part, static_cast<std::int32_t>(i));
    EXPECT_EQ(part.parts, static_cast<std::int32_t>(start_->parts.size()));
    EXPECT_EQ(part.frame_id, "f");
    EXPECT_LE(encode(part, 0).size(), 1400U);
    points.insert(points.end(), part.points.begin(), part.points.end());
  }
  EXPECT_GT(start_->parts.size(), 2U);
  EXPECT_EQ(points, downsample(map, site_.resolution, 0.5));
  EXPECT_EQ(answer.count, static_cast<std::int64_t>(points.size()));
}

TEST_F(IngestRequestTest, a_coarse_view_that_is_on_its_way_is_not_sent_twice) {
  site_.stream.bytes_per_second = 10'000;
  restart();
  say_octomap("robot1", "f", some_map(400));
  start_->run(5);
  const DownsampleRequest request{"q1", "robot1", 0.5};
  for (int i = 0; i < 5; ++i) {
    start_->bus.publish("in/downsample", encode(request, start_->bus.now()));
    start_->run(0.1);
  }
  start_->run(20);
  ASSERT_FALSE(start_->parts.empty());
  EXPECT_GT(start_->parts.front().parts, 2);
  EXPECT_EQ(start_->parts.size(), static_cast<std::size_t>(start_->parts.front().parts));
  EXPECT_EQ(start_->answers["q1"].size(), 1U);
  start_->parts.clear();
  start_->bus.publish("in/downsample", encode(request, start_->bus.now()));
  start_->run(10);
  EXPECT_FALSE(start_->parts.empty()) << "asked again later: parts may have been lost";
}

TEST_F(IngestRequestTest, a_coarse_view_needs_an_agent_and_a_sane_cell) {
  say_octomap("robot1", "f", some_map(4));
  EXPECT_EQ(start_->ask(DownsampleRequest{"q1", "nobody", 0.5}).code, "NO_AGENT");
  EXPECT_EQ(start_->ask(DownsampleRequest{"q2", "robot1", 0.05}).code, name(Code::kBadResolution));
  EXPECT_EQ(start_->ask(DownsampleRequest{"q3", "robot1", 11}).code, name(Code::kBadResolution));
  EXPECT_EQ(start_->ask(DownsampleRequest{"q4", "robot1", NAN}).code, name(Code::kBadResolution));
  EXPECT_TRUE(start_->parts.empty());
  EXPECT_TRUE(start_->ask(DownsampleRequest{"q5", "robot1", site_.resolution}).ok);
}

}  // namespace
}  // namespace concord::testing
