#include "cli/relief.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <unordered_map>

namespace concord {
namespace {

/// The occupied voxels of one column under the cut; none: bottom above top.
struct Column {
  std::int32_t top = std::numeric_limits<std::int32_t>::min();
  std::int32_t bottom = std::numeric_limits<std::int32_t>::max();
  bool known = false;

  [[nodiscard]] bool solid() const { return bottom <= top; }
};
/// Columns by brick (z = 0), x fastest.
using Columns = std::unordered_map<BrickIndex, std::array<Column, kBrickSide * kBrickSide>, IndexHash>;

constexpr int kMaxTints = 32;
constexpr int kMaxSide = 8192;   // cells; a picture needs no more, and memory stays bounded
constexpr double kMargin = 0.6;  // metres around what is drawn

Columns columns_of(const BrickMap& map, std::int32_t cut) {
  Columns columns;
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    if (origin_of(index).z >= cut) return;
    auto& block = columns[{index.x, index.y, 0}];
    brick.for_each([&](int local, LogOdds value) {
      const std::int32_t z = voxel_at(index, local).z;
      if (z >= cut) return;
      Column& column = block[local & 63];
      column.known = true;
      if (!is_occupied(value)) return;
      column.top = std::max(column.top, z);
      column.bottom = std::min(column.bottom, z);
    });
  });
  return columns;
}

/// Calls `visit(x, y, column)` for each column that holds a known voxel, in no particular order.
template <class Visit>
void for_each_column(const Columns& columns, Visit&& visit) {
  for (const auto& [index, block] : columns) {
    for (int i = 0; i < kBrickSide * kBrickSide; ++i) {
      const VoxelIndex v = voxel_at(index, i);
      if (block[i].known) visit(v.x, v.y, block[i]);
    }
  }
}

/// What is left of the values when a five-hundredth is taken off each end; a fiftieth where that makes the rest much
/// larger on the page, as with the few returns from beyond a room's windows.
std::pair<std::int32_t, std::int32_t> trimmed(std::vector<std::int32_t>& values) {
  std::ranges::sort(values);
  const std::size_t few = values.size() / 500, more = values.size() / 200, last = values.size() - 1;
  const std::int32_t worth = (values[last - few] - values[few]) / 6;
  return {values[values[more] - values[few] > worth ? more : few],
          values[last - (values[last - few] - values[last - more] > worth ? more : few)]};
}

/// The part of the lattice that is drawn.
struct Window {
  std::int32_t min_x, min_y, max_x, max_y;

  void include(const VoxelIndex& v) {
    min_x = std::min(min_x, v.x);
    max_x = std::max(max_x, v.x);
    min_y = std::min(min_y, v.y);
    max_y = std::max(max_y, v.y);
  }
};

Window window_of(const Overview& overview, std::vector<std::int32_t>& xs, std::vector<std::int32_t>& ys) {
  const auto [min_x, max_x] = trimmed(xs);
  const auto [min_y, max_y] = trimmed(ys);
  Window window{min_x, min_y, max_x, max_y};
  const auto include = [&](const Eigen::Vector2d& p) {
    window.include(voxel_of({p.x(), p.y(), 0.0}, overview.resolution));
  };
  for (const auto* route : {&overview.before, &overview.after}) {
    if (route->has_value()) std::ranges::for_each((*route)->points, include);
  }
  if (overview.start) include(*overview.start);
  if (overview.goal) include(*overview.goal);
  for (const VoxelIndex& v : overview.edit) window.include(v);
  const int margin = static_cast<int>(std::ceil(kMargin / overview.resolution));
  window = {window.min_x - margin, window.min_y - margin, window.max_x + margin, window.max_y + margin};
  window.max_x = std::min(window.max_x, window.min_x + kMaxSide - 1);
  window.max_y = std::min(window.max_y, window.min_y + kMaxSide - 1);
  return window;
}

/// Most of what is lowest in its column lies on the floor.
double floor_of(const std::map<std::int32_t, std::int64_t>& lowest, double resolution) {
  const auto most = std::ranges::max_element(lowest, {}, [](const auto& entry) { return entry.second; });
  return most == lowest.end() ? 0.0 : (most->first + 1) * resolution;
}

std::uint32_t claims_of(const Overview& overview, const VoxelIndex& voxel, const std::vector<Transform>& T_agent_map) {
  std::uint32_t claims = 0;
  const Eigen::Vector3d centre = centre_of(voxel, overview.resolution);
  for (std::size_t i = 0; i < T_agent_map.size(); ++i) {
    if (overview.agents[i].map == nullptr) continue;
    // Noise and a turned lattice put a surface up to one voxel beside the map's.
    bool found = false;
    for (int k = 0; k < 27 && !found; ++k) {
      const int step = (k + 13) % 27;  // the middle first
      const Eigen::Vector3d offset(step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1);
      const Eigen::Vector3d p = T_agent_map[i] * (centre + overview.resolution * offset);
      const LogOdds value = overview.agents[i].map->at(voxel_of(p, overview.resolution));
      found = is_known(value) && is_occupied(value);
    }
    if (found) claims |= std::uint32_t{1} << i;
  }
  return claims;
}

}  // namespace

Relief look_down(const Overview& overview) {
  const std::int32_t cut = static_cast<std::int32_t>(std::floor(overview.cut / overview.resolution));
  const Columns columns = columns_of(*overview.map, cut);
  std::vector<std::int32_t> xs, ys;
  std::map<std::int32_t, std::int64_t> lowest;
  for_each_column(columns, [&](std::int32_t x, std::int32_t y, const Column& column) {
    if (!column.solid()) return;
    xs.push_back(x);
    ys.push_back(y);
    ++lowest[column.bottom];
  });
  Relief relief;
  if (xs.empty()) return relief;

  const Window window = window_of(overview, xs, ys);
  relief.min_x = window.min_x;
  relief.min_y = window.min_y;
  relief.width = window.max_x - window.min_x + 1;
  relief.height = window.max_y - window.min_y + 1;
  relief.floor = floor_of(lowest, overview.resolution);
  relief.cells.resize(static_cast<std::size_t>(relief.width) * relief.height);

  std::vector<Transform> T_agent_map;
  for (const auto& agent : overview.agents) {
    if (T_agent_map.size() < kMaxTints) T_agent_map.push_back(agent.T_map_agent.inverse());
  }
  for_each_column(columns, [&](std::int32_t x, std::int32_t y, const Column& column) {
    Relief::Cell* cell = relief.at(x, y);
    if (cell == nullptr) return;
    cell->seen = true;
    if (!column.solid()) return;
    cell->top = static_cast<float>((column.top + 1) * overview.resolution);
    cell->claims = claims_of(overview, {x, y, column.top}, T_agent_map);
  });
  if (overview.conflicts != nullptr) {
    overview.conflicts->for_each_brick([&](BrickIndex index, const Brick& brick) {
      brick.for_each([&](int local, LogOdds value) {
        const VoxelIndex v = voxel_at(index, local);
        Relief::Cell* cell = relief.at(v.x, v.y);
        if (cell != nullptr && is_occupied(value) && v.z < cut) ++cell->conflicts;
      });
    });
  }
  return relief;
}

}  // namespace concord
