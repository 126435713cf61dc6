#include "cli/replay.hpp"
#include "cli/replay_expected.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include "cli/temporary_folder.hpp"
#include "session.hpp"

namespace concord::test {
namespace {

class ReplayTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { spdlog::set_default_logger(spdlog::stderr_color_mt("replay_test")); }

  static const std::vector<LogEvent>& session() {
    static const std::vector<LogEvent> kSession = record_session();
    return kSession;
  }
  std::filesystem::path write(const std::vector<LogEvent>& events) {
    const auto file = folder_.path() / ("log" + std::to_string(++logs_));
    write_log(file, events);
    return file;
  }
  Replayed replay(const std::vector<LogEvent>& events) { return replay(write(events)); }
  Replayed replay(const std::filesystem::path& log) {
    const Site site;
    auto replayed = replay_lockstep(log, site);
    EXPECT_TRUE(replayed) << (replayed ? "" : replayed.error().message);
    return replayed ? *replayed : Replayed{};
  }
  /// As a script calls it: exit code and what was printed.
  std::pair<int, nlohmann::json> run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"concord", "replay", "--json"});
    std::vector<const char*> argv;
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    Program program;
    add_replay(program);
    testing::internal::CaptureStdout();
    const int exit = program.run(static_cast<int>(argv.size()), argv.data());
    return {exit, nlohmann::json::parse(testing::internal::GetCapturedStdout())};
  }

  static std::string message(const nlohmann::json& result) { return result["error"]["message"]; }

  TemporaryFolder folder_{"replay-test"};
  int logs_ = 0;
};

/// The session without what `drop` says.
template <class Drop>
std::vector<LogEvent> without(std::vector<LogEvent> events, Drop drop) {
  std::erase_if(events, drop);
  return events;
}

TEST_F(ReplayTest, the_same_log_gives_the_same_results_every_time) {
  const Replayed first = replay(session());
  const Replayed second = replay(session());
  EXPECT_EQ(first.digests, second.digests);
  EXPECT_TRUE(first.gaps.empty());
  EXPECT_GT(first.map_bricks, 500U);
  EXPECT_EQ(first.messages, static_cast<std::int64_t>(session().size()));
  for (const char* result : {"map", "conflicts", "grid"}) EXPECT_NE(first.digests.at(result), 0U) << result;
}

TEST_F(ReplayTest, each_kind_of_input_counts) {
  const Replayed whole = replay(session());
  for (const char* channel : {"in/edit", "in/transform", "in/scanner/cloud"}) {
    const Replayed less = replay(without(session(), [&](const LogEvent& e) { return e.channel == channel; }));
    EXPECT_NE(less.digests.at("map"), whole.digests.at("map")) << channel;
  }
  const Replayed less = replay(without(session(), [](const LogEvent& e) { return e.channel == "in/path_request"; }));
  EXPECT_EQ(less.digests.at("map"), whole.digests.at("map"));
  EXPECT_NE(less.digests.at("paths"), whole.digests.at("paths"));
}

TEST_F(ReplayTest, the_order_in_which_agents_were_heard_does_not_count) {
  const std::uint64_t map = replay(session()).digests.at("map");
  for (const std::string first : {"in/scanner/", "in/robot2/", "in/robot1/"}) {
    // The same times, but of the first two seconds all of one agent's messages come first.
    std::vector<LogEvent> events = session();
    const auto people =
        std::find_if(events.begin(), events.end(), [](const LogEvent& e) { return e.channel == "in/transform"; });
    std::vector<std::int64_t> times;
    for (auto it = events.begin(); it != people; ++it) times.push_back(it->utime);
    std::stable_partition(events.begin(), people, [&](const LogEvent& e) { return e.channel.starts_with(first); });
    for (std::size_t i = 0; i < times.size(); ++i) events[i].utime = times[i];
    EXPECT_EQ(replay(events).digests.at("map"), map) << first;
  }
}

TEST_F(ReplayTest, repeated_and_repaired_packets_change_nothing) {
  std::vector<LogEvent> events;
  for (const LogEvent& event : session()) {
    events.push_back(event);
    if (event.channel.ends_with("/bricks") || event.channel == "in/edit") events.push_back(event);
  }
  EXPECT_EQ(replay(events).digests.at("map"), replay(session()).digests.at("map"));
}

TEST_F(ReplayTest, what_the_stack_said_then_is_not_played) {
  std::vector<LogEvent> events = session();
  events.insert(events.begin() + 10, {events[10].utime, "out/agent/robot1/bricks", {1, 2, 3}});
  EXPECT_EQ(replay(events).digests, replay(session()).digests);
}

TEST_F(ReplayTest, packets_that_the_logger_missed_are_named) {
  int packets = 0;
  const auto log =
      write(without(session(), [&](const LogEvent& e) { return e.channel == "in/robot2/bricks" && ++packets == 3; }));
  const auto [exit, result] = run({log});
  EXPECT_EQ(exit, 4);
  ASSERT_EQ(result["gaps"].size(), 1U);
  EXPECT_EQ(result["gaps"][0]["channel"], "in/robot2/bricks");
  EXPECT_GT(result["gaps"][0]["missing"], 0);
}

TEST_F(ReplayTest, clouds_that_the_logger_missed_are_named) {
  int clouds = 0;
  const auto log =
      write(without(session(), [&](const LogEvent& e) { return e.channel == "in/scanner/cloud" && ++clouds == 2; }));
  const auto [exit, result] = run({log});
  EXPECT_EQ(exit, 4);
  ASSERT_EQ(result["gaps"].size(), 1U);
  EXPECT_EQ(result["gaps"][0]["channel"], "in/scanner/cloud");
  EXPECT_EQ(result["gaps"][0]["missing"], 1);
}

TEST_F(ReplayTest, a_stream_that_this_release_cannot_read_is_named) {
  std::vector<LogEvent> events = session();
  for (LogEvent& event : events) {
    if (event.channel.starts_with("in/robot2/")) event.bytes[0] ^= 1;  // the type's fingerprint
  }
  const auto [exit, result] = run({write(events)});
  EXPECT_EQ(exit, 4);
  ASSERT_EQ(result["gaps"].size(), 2U);
  EXPECT_EQ(result["gaps"][0]["channel"], "in/robot2/bricks");
  EXPECT_EQ(result["gaps"][1]["channel"], "in/robot2/digest");
}

TEST_F(ReplayTest, streams_of_another_resolution_than_the_sites_are_named) {
  const auto site = folder_.path() / "site.yaml";
  std::ofstream(site) << "resolution: 0.1\n";
  const auto [exit, result] = run({"--site", site, write(session())});
  EXPECT_EQ(exit, 4);
  ASSERT_EQ(result["gaps"].size(), 2U);
  EXPECT_EQ(result["gaps"][0]["channel"], "in/robot1/bricks");
  EXPECT_EQ(result["gaps"][1]["channel"], "in/robot2/bricks");
  EXPECT_TRUE(result["gaps"][0]["missing"].is_null()) << "no number: none of it was taken";
  EXPECT_NE(result["gaps"][0]["what"].get<std::string>().find("resolution"), std::string::npos);
}

TEST_F(ReplayTest, expectations_are_compared) {
  const auto log = write(session());
  const auto [exit, result] = run({log});
  ASSERT_EQ(exit, 0);
  EXPECT_EQ(result["digest"], result["map_digest"]);
  const auto expect = folder_.path() / "expect.json";
  std::ofstream(expect) << result;
  EXPECT_EQ(run({log, "--expect", expect}).first, 0);

  nlohmann::json other = result;
  other["results"]["grid"] = "0";
  std::ofstream(expect) << other;
  const auto [differs, differences] = run({log, "--expect", expect});
  EXPECT_EQ(differs, 1);
  EXPECT_EQ(differences["differences"].size(), 1U);
}

TEST_F(ReplayTest, an_expectation_that_cannot_be_read_fails_before_the_log_is_looked_at) {
  const auto expect = folder_.path() / "expect.json";
  for (const char* text : {"{}", "nonsense", "[1]", "{\"results\": 3}"}) {
    std::ofstream(expect) << text;
    const auto [exit, result] = run({"no-such-log", "--expect", expect});
    EXPECT_EQ(exit, 2);
    EXPECT_NE(message(result).find("expect.json"), std::string::npos) << message(result);
  }
  EXPECT_NE(message(run({"no-such-log", "--expect", "none.json"}).second).find("none.json"), std::string::npos);
}

TEST_F(ReplayTest, live_only_the_map_is_compared) {
  const auto file = folder_.path() / "expect.json";
  std::ofstream(file) << R"({"results": {"map": "1", "paths": "2"}})";
  const nlohmann::json result = {{"results", {{"map", "1"}, {"paths", "3"}}}};
  EXPECT_TRUE(Expected::read(file, true).value().differences(result).empty());
  EXPECT_EQ(Expected::read(file, false).value().differences(result).size(), 1U);
  std::ofstream(file) << R"({"results": {"paths": "2"}})";
  EXPECT_EQ(Expected::read(file, true).error().code, Code::kEmpty);
}

TEST_F(ReplayTest, of_a_cut_log_all_whole_events_are_played_and_the_place_is_named) {
  const std::vector<LogEvent>& events = session();
  const auto log = write(events), without_last = write({events.begin(), events.end() - 1});
  const auto whole = std::filesystem::file_size(without_last);
  std::filesystem::resize_file(log, whole + 40);  // within the last event's channel or data
  const auto [exit, result] = run({log});
  EXPECT_EQ(exit, 4);
  EXPECT_EQ(result["cut"]["whole_events"], events.size() - 1);
  EXPECT_EQ(result["cut"]["byte"], whole);
  EXPECT_EQ(result["cut"]["bytes_lost"], 40);
  EXPECT_EQ(result["messages"], events.size() - 1);
  EXPECT_EQ(replay(log).digests, replay(without_last).digests);
  EXPECT_TRUE(run({without_last}).second["cut"].is_null());
}

TEST_F(ReplayTest, what_is_no_log_is_refused) {
  const auto file = folder_.path() / "nonsense";
  EXPECT_EQ(run({file}).first, 2);
  std::ofstream(file) << "this is no log, but it is longer than a header";
  EXPECT_EQ(run({file}).first, 2);
}

TEST_F(ReplayTest, a_clock_that_jumps_is_refused_with_its_place) {
  std::vector<LogEvent> jump = {session()[0], session()[1]};
  const auto before = write({jump[0]});
  jump[1].utime = jump[0].utime + std::int64_t{48} * 3600 * 1'000'000;
  const auto [exit, result] = run({write(jump)});
  EXPECT_EQ(exit, 2);
  const std::string said = message(result);
  EXPECT_NE(said.find("event 2, byte " + std::to_string(std::filesystem::file_size(before))), std::string::npos)
      << said;
  EXPECT_NE(said.find("from 2023-11-14 22:13:20.000000 UTC to 2023-11-16 22:13:20.000000 UTC"), std::string::npos)
      << said;
}

TEST_F(ReplayTest, a_log_with_nothing_to_play_is_refused) {
  std::vector<LogEvent> out = {session()[0]};
  out[0].channel = "out/map/bricks";
  const auto beginning = write({session()[0]});
  std::filesystem::resize_file(beginning, 40);
  for (const auto& log : {write({}), write(out), beginning}) {
    const auto [exit, result] = run({log});
    EXPECT_EQ(exit, 2);
    EXPECT_NE(message(result).find("holds nothing to play"), std::string::npos) << message(result);
  }
}

}  // namespace
}  // namespace concord::test
