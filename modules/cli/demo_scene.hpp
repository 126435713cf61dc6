#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "agent/sim/world.hpp"
#include "bus/site.hpp"
#include "core/brick_map.hpp"
#include "core/error.hpp"
#include "core/transform.hpp"

namespace concord {

/// What a demo is asked to show.
struct DemoOptions {
  std::filesystem::path out = "out/demo";
  std::vector<std::string> maps;            ///< two map files as agents a and b; empty: the simulated warehouse
  std::string transform = "0 0 0 0 0 0 1";  ///< T_a_b, with maps
  std::string from, to, edit_box;           ///< empty: the scene's own, if it has one
  std::vector<double> band;                 ///< zmin zmax; empty: the site file's
  bool headless = false;
  std::uint64_t seed = 1;  ///< of the warehouse
  double speed = 3.0;      ///< simulated seconds a second
};

/// One who sends a submap.
struct DemoAgent {
  std::string id, kind;
  int weight = 1;
  Transform T_map_agent = Transform::Identity();  ///< where it is known to be, roughly
  std::optional<BrickMap> file;                   ///< what it sends; absent: it is simulated
  double way_seconds = 0.0;                       ///< simulated, of its whole way
};

/// All that happens in a demo, as values.
struct DemoScene {
  double resolution = 0.05;
  double zmin = 0.0, zmax = 0.0;
  std::vector<DemoAgent> agents;  ///< the first is the robot that asks for paths
  std::optional<World> world;     ///< ground truth
  std::optional<Eigen::Vector2d> start, goal;
  std::vector<VoxelIndex> edit;
  std::string author = "visitor";
};

/// Refused: what is wrong with the options or the map files.
[[nodiscard]] Result<DemoScene> make_scene(const DemoOptions& options, const Site& site);

/// The site of a demo: the given one, with the scene's agents and resolution and a state of its own.
[[nodiscard]] Site demo_site(const DemoScene& scene, Site site, const std::filesystem::path& state);

}  // namespace concord
