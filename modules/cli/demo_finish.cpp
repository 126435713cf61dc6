// The part of DemoRun that comes when all is done: saving, scoring, the report, and leaving the stack to a person.

#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "cli/demo_run.hpp"
#include "cli/end_request.hpp"
#include "cli/map_file.hpp"
#include "cli/numbers.hpp"

namespace concord {
namespace {

constexpr double kWhole = 120.0;  // seconds for all streams to arrive

}  // namespace

DemoRun::Step DemoRun::collect() {
  if (const Step settled = settle("demo"); !settled) return settled;
  const auto synced = [this] {
    return copies_->conflicts.synced() &&
           std::ranges::all_of(copies_->agents, [](const auto& c) { return c.second->synced(); });
  };
  report_.streams_whole = live_->wait(kWhole, synced);
  if (!report_.streams_whole) say("not all streams arrived whole");
  if (auto written = save_map(folder_.map(), copies_->map.map(), scene_.resolution); !written) {
    return fail(written.error());
  }
  say("saved the map");
  return {};
}

void DemoRun::score() {
  if (!scene_.world) return;
  constexpr double kNearlyAll = 0.9;
  say("scoring against the true warehouse");
  const DemoAgent& robot = scene_.agents.front();
  const DemoScorer scorer(*scene_.world, scene_.resolution, robot.T_map_agent);
  report_.robot = scorer.robot(copies_->agents.at(robot.id)->map());
  for (std::size_t i = 0; i < scene_.agents.size(); ++i) {
    const DemoAgent& agent = scene_.agents[i];
    report_.agents[i].recall = scorer.alone(copies_->agents.at(agent.id)->map(), agent.T_map_agent).recall;
  }
  report_.merged = scorer.merged(before_edit_);
  if (!scene_.edit.empty()) report_.edited = scorer.merged(copies_->map.map());
  report_.one_agent_seconds = scorer.robot_reached(moments_, kNearlyAll * report_.merged->recall);
  report_.all_agents_seconds = scorer.merged_reached(moments_, kNearlyAll * report_.merged->recall);
}

DemoRun::Step DemoRun::tell() {
  report_.resolution = scene_.resolution;
  report_.cut = scene_.zmax;  // a lintel that a path goes under is above it
  report_.sources = options_.maps;
  report_.map = &copies_->map.map();
  report_.conflicts = &copies_->conflicts.map();
  for (const DemoAgent& agent : scene_.agents) {
    const AgentState* state = watch_->state_of(agent.id);
    if (state == nullptr) return fail(Exit::kIncomplete, "INCOMPLETE", "merge no longer lists " + agent.id);
    const std::int64_t lost = watch_->clouds_lost(agent);
    if (lost > 0) say(agent.id + ": " + format_count(lost) + " clouds were lost on their way to ingest");
    report_.agents.push_back(
        {*state, &copies_->agents.at(agent.id)->map(), watch_->bytes_sent(agent), lost, std::nullopt});
  }
  report_.edit = scene_.edit;
  report_.author = scene_.author;
  report_.start = scene_.start;
  report_.goal = scene_.goal;
  score();
  report_.seconds["total"] = now();
  if (auto written = write_report(report_, options_.out); !written) return fail(written.error());
  if (common_.json) common_.print(to_json(report_), "");
  say("report: " + (options_.out / "report.json").string() + ", picture: " + (options_.out / "overview.png").string());
  return {};
}

void DemoRun::show() {
  const std::filesystem::path page = std::filesystem::absolute(options_.out / "index.html");
  say("report: file://" + page.string());
  say("the map: " + person_->page());
  if (isatty(STDIN_FILENO) == 0) return;
  say("the stack goes on until Ctrl-C; open the map in a browser, or try ./run concord status, ./run spy");
  while (!end_requested()) live_->wait(0.5, end_requested);
}

}  // namespace concord
