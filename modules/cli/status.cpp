#include <map>

#include <nlohmann/json.hpp>

#include "cli/live.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

/// Every process says its status once a second.
constexpr double kListen = 1.5;

Outcome status(const Common& common) {
  Live live(common);
  std::map<std::string, ProcessStatus> heard;
  live.hear<ProcessStatus>("out/status/.*",
                           [&](const std::string&, ProcessStatus s) { heard[s.process] = std::move(s); });
  live.wait(kListen, [] { return false; });
  if (heard.empty()) return live.no_answer("the stack");
  nlohmann::json processes = nlohmann::json::object();
  std::string words;
  for (const auto& [name, process] : heard) {
    processes[name] = {{"up_seconds", static_cast<double>(process.utime - process.boot_id) / 1e6},
                       {"counters", process.counters}};
    words += name + "  up " + format_number(static_cast<double>(process.utime - process.boot_id) / 1e6, 0) + " s\n";
    for (const auto& [counter, value] : process.counters) words += "  " + counter + "  " + format_count(value) + "\n";
  }
  common.print({{"processes", processes}}, words);
  return Exit::kDone;
}

Outcome agents(const Common& common) {
  Live live(common);
  const auto list = hear_agents(live);
  if (!list) return tl::unexpected(list.error());
  nlohmann::json array = nlohmann::json::array();
  std::string words;
  for (const AgentState& agent : list->agents) {
    array.push_back(to_json(agent));
    words += agent.id + "  " + agent.kind + (agent.frame_id.empty() ? "  no frame" : "  frame " + agent.frame_id) +
             "  weight " + std::to_string(agent.weight) + (agent.aligned ? "  aligned" : "  not aligned") + "  " +
             format_count(agent.known) + " known, " + format_count(agent.occupied) + " occupied" +
             (agent.synced ? "" : "  (still arriving)") + "\n";
  }
  common.print({{"agents", array}}, words.empty() ? "no agents" : words);
  return Exit::kDone;
}

}  // namespace

void add_status(Program& program) {
  program.add("status", "the processes that run, and what they have counted", status);
}

void add_agents(Program& program) { program.add("agents", "every agent the stack knows", agents); }

}  // namespace concord
