#include "planner/zone_cells.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

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

/// Cells from the first to the last, by row.
using Runs = std::map<std::int32_t, std::vector<std::pair<std::int32_t, std::int32_t>>>;

/// In order, apart from each other.
void join(std::vector<std::pair<std::int32_t, std::int32_t>>& runs) {
  std::sort(runs.begin(), runs.end());
  std::size_t last = 0;
  for (std::size_t i = 1; i < runs.size(); ++i) {
    if (runs[i].first <= runs[last].second + 1) {
      runs[last].second = std::max(runs[last].second, runs[i].second);
    } else {
      runs[++last] = runs[i];
    }
  }
  if (!runs.empty()) runs.resize(last + 1);
}

Runs runs_of(const std::vector<ColumnPlane>& columns) {
  Runs rows;
  for (const ColumnPlane& plane : columns) {
    for (int y = 0; y < 8; ++y) {
      auto bits = static_cast<std::uint8_t>(plane.cells >> (8 * y));
      while (bits != 0) {
        const int first = std::countr_zero(bits);
        const int count = std::countr_one(static_cast<std::uint8_t>(bits >> first));
        rows[plane.column.y * 8 + y].emplace_back(plane.column.x * 8 + first, plane.column.x * 8 + first + count - 1);
        bits = static_cast<std::uint8_t>(bits & ~(((1U << count) - 1) << first));
      }
    }
  }
  for (auto& [y, runs] : rows) join(runs);
  return rows;
}

/// So many cells wider is a run, `rows` rows away from it, for whose squares come nearer than `margin` cells; -1: none.
int wider_by(int rows, double margin) {
  const double apart = std::max(rows - 1, 0);
  if (apart >= margin) return -1;
  return static_cast<int>(std::ceil(std::sqrt(margin * margin - apart * apart) - kOnFace));
}

/// With what lies nearer to them than `margin` cells, within the map's bounds.
ZoneCells grown(const ZoneCells& zone, double margin) {
  Runs rows;
  for (const auto& [y, runs] : runs_of(zone.columns)) {
    for (int away = 0, wider = 0; (wider = wider_by(away, margin)) >= 0; ++away) {
      for (const auto& [first, last] : runs) {
        const std::pair run{std::max(first - wider, -kMaxVoxel), std::min(last + wider, kMaxVoxel - 1)};
        if (y + away < kMaxVoxel) rows[y + away].push_back(run);
        if (away > 0 && y - away >= -kMaxVoxel) rows[y - away].push_back(run);
      }
    }
  }
  ZoneCells out;
  if (rows.empty()) return out;
  std::map<BrickIndex, std::uint64_t> planes;
  out.bounds = {{kMaxVoxel, rows.begin()->first}, {-kMaxVoxel, rows.rbegin()->first}};
  for (auto& [y, runs] : rows) {
    join(runs);
    for (const auto& [first, last] : runs) {
      out.count += last - first + 1;
      out.bounds.low.x = std::min(out.bounds.low.x, first);
      out.bounds.high.x = std::max(out.bounds.high.x, last);
      const CellRectangle run{{first, y}, {last, y}};
      for (std::int32_t x = first >> 3; x <= last >> 3; ++x) {
        const BrickIndex column{x, y >> 3, 0};
        planes[column] |= run.plane(column);
      }
    }
  }
  for (const auto& [column, cells] : planes) out.columns.push_back({column, cells});
  return out;
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
      })
      .and_then([&](ZoneCells cells) -> Result<ZoneCells> {
        if (zone.margin > 0) cells = grown(cells, zone.margin / resolution);
        if (cells.count > most) return refuse(Code::kTooLarge, "the zone and its margin have too many cells");
        return cells;
      });
}

Result<std::int64_t> count(const Zone& zone, double resolution, const Band& band, std::int64_t most) {
  const Heights heights = heights_of(band, resolution);
  auto cells = footprint_count(zone.volume, zone.T_map_zone, resolution, heights.low, heights.high, most);
  if (!cells || zone.margin == 0) return cells;
  const CellRectangle around = rectangle_around(zone, resolution, band);
  const std::int64_t all =
      (std::int64_t{around.high.x} - around.low.x + 1) * (std::int64_t{around.high.y} - around.low.y + 1);
  if (all > most) return refuse(Code::kTooLarge, "the zone and its margin have too many cells");
  return all;
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
  const double wider = zone.margin > 0 ? zone.margin + resolution : 0;
  const Heights heights = heights_of(band, resolution);
  if (box.min().z() > heights.high + slack || box.max().z() < heights.low - slack) return {};
  const auto cell_at = [&](double metres) {
    return static_cast<std::int32_t>(std::clamp<double>(std::floor(metres / resolution), -kMaxVoxel, kMaxVoxel - 1));
  };
  return {{cell_at(box.min().x() - slack - wider), cell_at(box.min().y() - slack - wider)},
          {cell_at(box.max().x() + slack + wider), cell_at(box.max().y() + slack + wider)}};
}

bool same_ground(const Zone& a, const Zone& b) {
  return a.kind == b.kind && a.margin == b.margin && a.cost == b.cost &&
         a.T_map_zone.matrix() == b.T_map_zone.matrix() && std::visit(SameVolume{}, a.volume, b.volume);
}

}  // namespace concord
