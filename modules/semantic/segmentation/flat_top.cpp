#include "semantic/segmentation/flat_top.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <set>

#include "semantic/segmentation/cell_rectangle.hpp"

namespace concord {
namespace {

/// In metres: a gap in a column that does not part what is above it from what is below.
constexpr double kGap = 0.15;
constexpr double kOutlineStep = 0.1;
constexpr double kHighestTop = 1.3;  ///< above the seed
constexpr double kRoomNear = 0.4;    ///< the roomiest place is looked for this near

constexpr std::array<std::pair<int, int>, 4> kBeside{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

int voxels_in(double metres, double resolution) {
  return std::max(1, static_cast<int>(std::lround(metres / resolution)));
}

/// A level surface that grows from one column.
class Growth {
 public:
  Growth(const BrickMasks& occupied, Cell from, std::int32_t z, double resolution)
      : occupied_(occupied),
        z_(z),
        off_(voxels_in(kFlatOff, resolution)),
        headroom_(voxels_in(kFlatHeadroom, resolution)),
        most_(voxels_in(kMostFlatExtent, resolution)) {
    grow(from);
  }

  [[nodiscard]] const std::map<Cell, std::int32_t>& heights() const { return heights_; }

  /// Of the cells within this many steps of `from`, the one farthest from the edge; of equals the nearest.
  [[nodiscard]] Cell roomiest(Cell from, int steps) const {
    const std::map<Cell, int> rooms = rooms_of_all();
    Cell best = from;
    std::pair<int, int> best_rank{-1, 0};
    for (const auto& [cell, room] : rooms) {
      const int away = std::max(std::abs(cell.first - from.first), std::abs(cell.second - from.second));
      if (away <= steps && std::pair(room, -away) > best_rank) best = cell, best_rank = {room, -away};
    }
    return best;
  }

 private:
  /// The voxel of a column near this layer that something could stand on.
  [[nodiscard]] std::optional<std::int32_t> top_of(Cell cell) const {
    int clear = 0;
    for (std::int32_t at = z_ + off_ + headroom_; at >= z_ - off_; --at) {
      if (!occupied_.contains({cell.first, cell.second, at})) {
        ++clear;
      } else if (at <= z_ + off_ && clear >= headroom_) {
        return at;
      } else {
        clear = 0;
      }
    }
    return std::nullopt;
  }

  void grow(Cell from) {
    const auto top = top_of(from);
    if (!top) return;
    heights_[from] = *top;
    std::deque<Cell> open{from};
    while (!open.empty()) {
      const Cell at = open.front();
      open.pop_front();
      for (const auto& [dx, dy] : kBeside) {
        const Cell next{at.first + dx, at.second + dy};
        const bool far = std::abs(next.first - from.first) > most_ || std::abs(next.second - from.second) > most_;
        if (far || heights_.contains(next)) continue;
        const auto height = top_of(next);
        if (!height || std::abs(*height - heights_[at]) > 1) continue;
        heights_[next] = *height;
        open.push_back(next);
      }
    }
  }

  /// For each cell, steps to the edge.
  [[nodiscard]] std::map<Cell, int> rooms_of_all() const {
    std::map<Cell, int> rooms;
    std::deque<Cell> open;
    for (const auto& entry : heights_) {
      const Cell& cell = entry.first;  // clang 14 captures no structured binding
      const bool at_edge = std::ranges::any_of(kBeside, [&](const auto& d) {
        return !heights_.contains({cell.first + d.first, cell.second + d.second});
      });
      if (at_edge) rooms[cell] = 1, open.push_back(cell);
    }
    while (!open.empty()) {
      const Cell at = open.front();
      open.pop_front();
      for (const auto& [dx, dy] : kBeside) {
        const Cell next{at.first + dx, at.second + dy};
        if (!heights_.contains(next) || rooms.contains(next)) continue;
        rooms[next] = rooms[at] + 1;
        open.push_back(next);
      }
    }
    return rooms;
  }

  const BrickMasks& occupied_;
  std::int32_t z_;
  int off_, headroom_, most_;
  std::map<Cell, std::int32_t> heights_;
};

/// Cells beside those of a top, up to 0.5 m away, where something stands higher than it.
std::vector<Cell> covered_around(const std::map<Cell, std::int32_t>& heights, std::int32_t z,
                                 const BrickMasks& occupied, double resolution) {
  const int low = voxels_in(kFlatOff, resolution), high = voxels_in(1.0, resolution);
  std::set<Cell> covered, rim, seen;
  for (const auto& [cell, height] : heights) rim.insert(cell);
  for (int step = voxels_in(0.5, resolution); step > 0 && !rim.empty(); --step) {
    std::set<Cell> next;
    for (const Cell& cell : rim) {
      for (const auto& [dx, dy] : kBeside) {
        const Cell beside{cell.first + dx, cell.second + dy};
        if (heights.contains(beside) || !seen.insert(beside).second) continue;
        for (std::int32_t at = z + low + 1; at <= z + high; ++at) {
          if (!occupied.contains({beside.first, beside.second, at})) continue;
          next.insert(beside);
          break;
        }
      }
    }
    covered.insert(next.begin(), next.end());
    rim = std::move(next);
  }
  return {covered.begin(), covered.end()};
}

std::int32_t median(const std::map<Cell, std::int32_t>& heights) {
  std::vector<std::int32_t> z;
  for (const auto& [cell, height] : heights) z.push_back(height);
  std::ranges::nth_element(z, z.begin() + static_cast<std::ptrdiff_t>(z.size() / 2));
  return z[z.size() / 2];
}

/// Where something rises beside a seat, next to it: see kRestHeight, kRestDepth.
std::vector<Cell> rests_of(const FlatTop& top, const BrickMasks& occupied, double resolution) {
  const int highest = voxels_in(kRestHeight, resolution), lowest = voxels_in(kFlatOff, resolution);
  const auto rises = [&](Cell cell) {
    for (std::int32_t z = top.z + highest; z > top.z + lowest; --z) {
      if (occupied.contains({cell.first, cell.second, z}))
        return !occupied.contains({cell.first, cell.second, top.z + highest + 1});
    }
    return false;
  };
  std::set<Cell> rest;
  const int most = voxels_in(kRestDepth, resolution);
  for (const auto& entry : top.cells) {
    for (const auto& d : kBeside) {
      const Cell& cell = entry.first;  // clang 14 captures no structured binding
      const auto beside = [&](int step) { return Cell{cell.first + step * d.first, cell.second + step * d.second}; };
      int deep = 0;
      while (deep <= most && !top.cells.contains(beside(deep + 1)) && rises(beside(deep + 1))) ++deep;
      if (deep > most) continue;  // more than a back: something stands there
      for (int step = 1; step <= deep; ++step) rest.insert(beside(step));
    }
  }
  return {rest.begin(), rest.end()};
}

/// The level surface that is first above a place in its column.
std::optional<FlatTop> top_above(const BrickMasks& occupied, std::int32_t floor_z, VoxelIndex seed, double resolution) {
  const int highest = voxels_in(kHighestTop, resolution), gap = voxels_in(kGap, resolution);
  std::int32_t last_seen = seed.z;
  for (std::int32_t z = seed.z; z <= seed.z + highest && z - last_seen <= gap; ++z) {
    if (!occupied.contains({seed.x, seed.y, z})) continue;
    last_seen = z;
    if (occupied.contains({seed.x, seed.y, z + 1})) continue;  // not yet the top
    const Growth growth(occupied, {seed.x, seed.y}, z, resolution);
    if (growth.heights().empty()) continue;
    std::vector<Cell> cells;
    for (const auto& [cell, height] : growth.heights()) cells.push_back(cell);
    const CellRectangle part =
        rectangle_around(cells, covered_around(growth.heights(), z, occupied, resolution),
                         growth.roomiest({seed.x, seed.y}, voxels_in(kRoomNear, resolution)), resolution, kOutlineStep);
    if (part.width < kLeastFlatWidth) continue;
    FlatTop top;
    top.z = median(growth.heights());
    for (const Cell& cell : part.cells) {
      const auto it = growth.heights().find(cell);
      top.cells[cell] = it != growth.heights().end() ? it->second : top.z;
    }
    top.width = part.width;
    const double above_floor = (top.z - floor_z) * resolution;
    if (above_floor >= kSeatLow && above_floor <= kSeatHigh) top.behind = rests_of(top, occupied, resolution);
    return top;
  }
  return std::nullopt;
}

}  // namespace

std::optional<FlatTop> find_flat_top(const BrickMasks& free_of_room, std::int32_t floor_z, VoxelIndex seed,
                                     double resolution) {
  const int side = voxels_in(kFlatSide, resolution);
  for (int ring = 0; ring <= side; ++ring) {
    for (int dx = -ring; dx <= ring; ++dx) {
      for (int dy = -ring; dy <= ring; ++dy) {
        if (std::max(std::abs(dx), std::abs(dy)) != ring) continue;
        auto top = top_above(free_of_room, floor_z, {seed.x + dx, seed.y + dy, seed.z}, resolution);
        if (top) return top;
      }
    }
  }
  return std::nullopt;
}

void reach_walls(FlatTop& top, const BrickMasks& room, double resolution) {
  const int gap = voxels_in(kGapToWall, resolution), high = voxels_in(kFlatHeadroom, resolution);
  const auto is_wall = [&](Cell cell) {
    for (std::int32_t z = top.z; z <= top.z + high; ++z) {
      if (room.contains({cell.first, cell.second, z})) return true;
    }
    return false;
  };
  std::set<Cell> between;
  for (const auto& entry : top.cells) {
    for (const auto& d : kBeside) {
      const Cell& cell = entry.first;  // clang 14 captures no structured binding
      const auto beside = [&](int step) { return Cell{cell.first + step * d.first, cell.second + step * d.second}; };
      int step = 1;
      while (step <= gap + 1 && !top.cells.contains(beside(step)) && !is_wall(beside(step))) ++step;
      if (step > gap + 1 || top.cells.contains(beside(step))) continue;
      while (--step > 0) between.insert(beside(step));
    }
  }
  for (const Cell& cell : between) top.cells.emplace(cell, top.z);
}

}  // namespace concord
