#include "planner/zone_cells.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace concord {
namespace {

constexpr CellRectangle kEverything{{-kMaxVoxel, -kMaxVoxel}, {kMaxVoxel - 1, kMaxVoxel - 1}};

/// Of the voxels that the band takes and of the heights that were asked for: whichever reaches further.
struct Heights {
  double low, high;
};
Heights heights_of(const Band& band, double resolution) {
  return {std::min(band.floor, band.first * resolution), std::max(band.ceiling, band.last * resolution)};
}

/// Neighbours along y within a column are in one plane; a column comes up to eight times.
std::vector<ColumnPlane> slices_of(const std::vector<VoxelIndex>& cells) {
  std::vector<ColumnPlane> slices;
  for (const VoxelIndex& cell : cells) {
    const BrickIndex column{cell.x >> 3, cell.y >> 3, 0};
    if (slices.empty() || slices.back().column != column) slices.push_back({column, 0});
    slices.back().cells |= std::uint64_t{1} << local_of(cell);
  }
  return slices;
}

/// Ascending, each column once.
std::vector<ColumnPlane> merged(std::vector<ColumnPlane> slices) {
  std::sort(slices.begin(), slices.end(),
            [](const ColumnPlane& a, const ColumnPlane& b) { return a.column < b.column; });
  std::vector<ColumnPlane> columns;
  for (const ColumnPlane& slice : slices) {
    if (columns.empty() || columns.back().column != slice.column) columns.push_back({slice.column, 0});
    columns.back().cells |= slice.cells;
  }
  return columns;
}

CellRectangle bounds_of(const std::vector<VoxelIndex>& cells) {
  if (cells.empty()) return {};
  const auto [low, high] = std::minmax_element(cells.begin(), cells.end(),
                                               [](const VoxelIndex& a, const VoxelIndex& b) { return a.y < b.y; });
  return {{cells.front().x, low->y}, {cells.back().x, high->y}};
}

struct SameVolume {
  bool operator()(const Box& a, const Box& b) const { return a.min == b.min && a.max == b.max; }
  bool operator()(const OrientedBox& a, const OrientedBox& b) const {
    return a.T_frame_box.matrix() == b.T_frame_box.matrix() && a.size == b.size;
  }
  bool operator()(const Prism& a, const Prism& b) const {
    return a.points == b.points && a.low == b.low && a.high == b.high;
  }
  template <class A, class B>
  bool operator()(const A& /*a*/, const B& /*b*/) const {
    return false;
  }
};

}  // namespace

std::uint64_t CellRectangle::plane(BrickIndex column) const {
  const int left = std::max(low.x - 8 * column.x, 0);
  const int right = std::min(high.x - 8 * column.x, 7);
  if (left > right) return 0;
  const std::uint64_t row = 0xFFU >> (7 - right) & 0xFFU << left;
  std::uint64_t cells = 0;
  for (int y = std::max(low.y - 8 * column.y, 0); y <= std::min(high.y - 8 * column.y, 7); ++y) cells |= row << (8 * y);
  return cells;
}

std::uint64_t ZoneCells::plane(BrickIndex column) const {
  const auto it = std::lower_bound(columns.begin(), columns.end(), column,
                                   [](const ColumnPlane& p, BrickIndex wanted) { return p.column < wanted; });
  return it != columns.end() && it->column == column ? it->cells : 0;
}

Result<ZoneCells> draw(const Zone& zone, double resolution, const Band& band, std::int64_t most) {
  const Heights heights = heights_of(band, resolution);
  return footprint(zone.volume, zone.T_map_zone, resolution, heights.low, heights.high, most)
      .map([](const std::vector<VoxelIndex>& cells) {
        return ZoneCells{static_cast<std::int64_t>(cells.size()), merged(slices_of(cells)), bounds_of(cells)};
      });
}

Result<std::int64_t> count(const Zone& zone, double resolution, const Band& band, std::int64_t most) {
  const Heights heights = heights_of(band, resolution);
  return footprint_count(zone.volume, zone.T_map_zone, resolution, heights.low, heights.high, most);
}

CellRectangle rectangle_around(const Zone& zone, double resolution, const Band& band) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& corner : corners(zone.volume)) {
    const Eigen::Vector3d p_map = zone.T_map_zone * corner;
    if (!p_map.allFinite()) return kEverything;
    box.extend(p_map);
  }
  if (box.isEmpty()) return kEverything;
  const double slack = kOnFace * resolution;
  const Heights heights = heights_of(band, resolution);
  if (box.min().z() > heights.high + slack || box.max().z() < heights.low - slack) return {};
  const auto cell_at = [&](double metres) {
    return static_cast<std::int32_t>(std::clamp<double>(std::floor(metres / resolution), -kMaxVoxel, kMaxVoxel - 1));
  };
  return {{cell_at(box.min().x() - slack), cell_at(box.min().y() - slack)},
          {cell_at(box.max().x() + slack), cell_at(box.max().y() + slack)}};
}

bool same_ground(const Zone& a, const Zone& b) {
  return a.kind == b.kind && a.T_map_zone.matrix() == b.T_map_zone.matrix() &&
         std::visit(SameVolume{}, a.volume, b.volume);
}

}  // namespace concord
