#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/brick_map.hpp"
#include "core/error.hpp"
#include "core/transform.hpp"

namespace concord {

/// What one page about a map shows. Everything is in the map frame, metres; the maps must outlive the call.
struct Overview {
  struct Agent {
    std::string id;
    const BrickMap* map = nullptr;  ///< in the agent's own lattice; null: listed, but tints nothing
    Transform T_map_agent = Transform::Identity();
    std::int64_t voxels = 0;  ///< known ones, as told in the legend
  };
  struct Route {
    std::string status;  ///< "OK" or why there is none
    std::vector<Eigen::Vector2d> points;
    double length = 0.0;
    std::string message = {};  ///< why there is none, for a person
  };
  /// A line of the table of things to find: the share of each (0 to 1) that was found; absent: not measured.
  struct Feature {
    std::string name;
    std::optional<double> robot, merged, edited;
  };

  std::string title;
  std::string subtitle;
  double resolution = 0.05;
  double cut = 2.3;  ///< height of the horizontal section: what lies above is not drawn
  const BrickMap* map = nullptr;
  const BrickMap* conflicts = nullptr;  ///< null: not shown
  std::vector<Agent> agents;            ///< at most 32 tint the map
  std::vector<VoxelIndex> edit;         ///< voxels that a person pinned
  std::optional<Route> before, after;   ///< the same request before and after the edit
  std::optional<Eigen::Vector2d> start, goal;
  std::vector<Eigen::Vector2d> driven;  ///< where a robot was on its way, a mark for each
  std::vector<Feature> features;
  std::vector<std::pair<std::string, std::string>> numbers;  ///< name and value, as they are printed
};

/// Where the map lies on the page: for whoever wants to point at something on it.
struct OverviewFrame {
  int width = 0, height = 0;      ///< of the page, pixels
  Eigen::Vector2d origin;         ///< pixel of map point (0, 0)
  double pixels_per_metre = 0.0;  ///< x to the right, map y up the page

  [[nodiscard]] Eigen::Vector2d pixel_of(const Eigen::Vector2d& p_map) const {
    return {origin.x() + p_map.x() * pixels_per_metre, origin.y() - p_map.y() * pixels_per_metre};
  }
};

/// Draws the page as a PNG: the map from above, cut like an architect's plan, tinted by the agents that claim each
/// surface, with conflicts, the edit and both routes; legend and numbers beside it.
/// Refused: a map that holds nothing (kEmpty), a file that cannot be written (kIo).
[[nodiscard]] Result<OverviewFrame> write_overview(const Overview& overview, const std::filesystem::path& png);

}  // namespace concord
