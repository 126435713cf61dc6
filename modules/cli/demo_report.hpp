#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "agent/sim/score.hpp"
#include "cli/overview.hpp"
#include "core/requests.hpp"

namespace concord {

/// What a demo found out. What was not asked, or has no ground truth, is absent.
struct DemoReport {
  struct Agent {
    AgentState state;
    const BrickMap* map = nullptr;  ///< its submap, agent's frame
    std::int64_t bytes_sent = 0;
    std::int64_t clouds_lost = 0;                 ///< that ingest never got, by their numbers
    std::optional<double> recall = std::nullopt;  ///< share of the true surface that its submap alone shows
  };

  double resolution = 0.05;
  double cut = 2.3;
  std::vector<std::string> sources;  ///< map files; empty: simulated agents
  const BrickMap* map = nullptr;     ///< as the stack ends with it
  const BrickMap* conflicts = nullptr;
  std::vector<Agent> agents;
  std::vector<VoxelIndex> edit;
  std::string author;
  std::optional<MapScore> robot, merged, edited;  ///< one robot alone, all merged, and after the edit
  std::optional<Path> path_before, path_after;
  std::optional<bool> arrived;          ///< whether the robot came to the goal, where it can drive
  std::vector<Eigen::Vector2d> driven;  ///< from the start, where it was: map frame, half a metre apart
  std::optional<bool> replanned;        ///< whether the active path was, by itself, when the edit crossed it
  /// Simulated seconds until nine tenths of the surface in the merged map (its recall before the edit) were shown by
  /// the first robot's own submap, and by the merged map; absent where they never were.
  std::optional<double> one_agent_seconds, all_agents_seconds;
  std::optional<Eigen::Vector2d> start, goal;
  std::map<std::string, double> seconds;  ///< how long each part took
  bool streams_whole = true;              ///< every brick stream arrived to its last version

  [[nodiscard]] std::int64_t bytes_sent() const;
  [[nodiscard]] std::int64_t clouds_lost() const;
  /// All that the agents sent is in what is reported: streams are whole and no cloud was lost.
  [[nodiscard]] bool complete() const { return streams_whole && clouds_lost() == 0; }
};

[[nodiscard]] nlohmann::json to_json(const DemoReport& report);
[[nodiscard]] Overview to_overview(const DemoReport& report);
/// The page that shows overview.png and the report's numbers.
[[nodiscard]] std::string to_html(const DemoReport& report);

/// Writes report.json, overview.png and index.html. Refused: kIo, kEmpty.
[[nodiscard]] Result<void> write_report(const DemoReport& report, const std::filesystem::path& folder);

}  // namespace concord
