#include "pose_cases.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>

#include "planner/files/map_server.hpp"
#include "planner/files/movingai.hpp"
#include "planner/footprint/standing_room.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class T>
T value(Result<T> result, const fs::path& file) {
  if (!result) throw std::runtime_error(file.string() + ": " + result.error().message);
  return std::move(*result);
}

struct Building {
  MapServerInfo info;
  BrickMap cells;
};

Building load(const fs::path& yaml) {
  const auto info = value(read_map_server_yaml(read(yaml)), yaml);
  const std::string pgm = read(yaml.parent_path() / info.image);
  return {info,
          value(read_map_server_pgm(info, {reinterpret_cast<const std::uint8_t*>(pgm.data()), pgm.size()}), yaml)};
}

/// The first of some yaws with which it has room there; they differ from query to query.
std::optional<Pose> pose_at(const StandingRoom& room, Cell cell, std::size_t query) {
  for (std::size_t i = 0; i < 32; ++i) {
    const double yaw = wrapped(2.399963 * static_cast<double>(query + i * 7));
    const Pose pose{{cell.x + 0.5, cell.y + 0.5}, yaw};
    if (room.stands(pose)) return pose;
  }
  return std::nullopt;
}

PoseCase make_case(const std::string& name, OpenGrid grid, double resolution, const fs::path& scen, std::size_t count) {
  const auto queries = value(read_movingai_scenario(read(scen), grid.width(), grid.height()), scen);
  PoseCase c{name, std::move(grid), resolution, {}};
  const DistanceField field(c.grid, 60);
  const StandingRoom room(c.grid, field, pose_case_robot().scaled(1 / resolution));
  // Their rows count from the top.
  const auto upright = [&](Cell cell) { return Cell{cell.x, c.grid.height() - 1 - cell.y}; };
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = i * queries.size() / count; k < (i + 1) * queries.size() / count; ++k) {
      const auto start = pose_at(room, upright(queries[k].start), 2 * k);
      const auto goal = pose_at(room, upright(queries[k].goal), 2 * k + 1);
      if (!start || !goal) continue;
      c.queries.push_back({{start->p * resolution, start->yaw}, {goal->p * resolution, goal->yaw}});
      break;
    }
  }
  return c;
}

}  // namespace

Footprint pose_case_robot() { return *make_rectangle(1.2, 0.8); }

std::vector<PoseCase> pose_cases(const fs::path& data, std::size_t count) {
  std::vector<PoseCase> cases;
  for (const std::string name : {"depot", "warehouse", "warehouse_keepout"}) {
    const bool is_fenced = name == "warehouse_keepout";
    const Building building = load(data / "buildings" / (is_fenced ? "warehouse.yaml" : name + ".yaml"));
    const fs::path scen = data / "buildings_conf" / (name + "_r030.map.scen");
    const auto size = value(read_movingai_map(read(fs::path(scen).replace_extension(""))), scen);
    OpenGrid grid(size.width(), size.height());
    const Building fences = is_fenced ? load(data / "buildings" / "warehouse_keepout.yaml") : Building{};
    for (int y = 0; y < grid.height(); ++y) {
      for (int x = 0; x < grid.width(); ++x) {
        const VoxelIndex cell{x, y, 0};
        grid.set({x, y}, is_free(building.cells.at(cell)) && !is_occupied(fences.cells.at(cell)));
      }
    }
    cases.push_back(make_case(name, std::move(grid), building.info.resolution, scen, count));
  }
  return cases;
}

}  // namespace concord
