#include "cli/status.hpp"

#include "cli/live.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "cli/stack.hpp"

namespace concord {
namespace {

/// Every process says its status once a second. All are listened to for so long, seconds,
constexpr double kListen = 1.5;
/// and those that should be there for so long more.
constexpr double kMissing = 1.5;

double up_seconds(const ProcessStatus& process) { return static_cast<double>(process.utime - process.boot_id) / 1e6; }

Outcome status(const Common& common) {
  Live live(common);
  Statuses heard;
  live.hear<ProcessStatus>("out/status/.*",
                           [&](const std::string&, ProcessStatus s) { heard[s.process] = std::move(s); });
  live.wait(kListen, [] { return false; });
  live.wait(kMissing, [&] { return missing(heard).empty(); });
  if (heard.empty()) return live.no_answer("the stack");
  common.print(to_json(heard), to_words(heard));
  return missing(heard).empty() ? Exit::kDone : Exit::kNegative;
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

std::vector<std::string> missing(const Statuses& heard) {
  std::vector<std::string> names;
  for (const char* name : kStackProcesses) {
    if (!heard.contains(name)) names.emplace_back(name);
  }
  return names;
}

nlohmann::json to_json(const Statuses& heard) {
  nlohmann::json processes = nlohmann::json::object();
  for (const auto& [name, process] : heard) {
    processes[name] = {{"up_seconds", up_seconds(process)}, {"counters", process.counters}};
  }
  return {{"processes", processes}, {"missing", missing(heard)}};
}

std::string to_words(const Statuses& heard) {
  std::string words;
  for (const auto& [name, process] : heard) {
    words += name + "  up " + format_number(up_seconds(process), 0) + " s\n";
    for (const auto& [counter, value] : process.counters) words += "  " + counter + "  " + format_count(value) + "\n";
  }
  for (const std::string& name : missing(heard))
    words += name + "  MISSING: nothing is heard of concord-" + name + "\n";
  return words;
}

void add_status(Program& program) {
  program.add("status", "the processes that run, and what they have counted", status);
}

void add_agents(Program& program) { program.add("agents", "every agent the stack knows", agents); }

}  // namespace concord
