#include "planner/robot_grid.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <set>
#include <utility>

namespace concord {
namespace {

std::int64_t cells_of(const CellRectangle& area) {
  return (std::int64_t{area.high.x} - area.low.x + 1) * (std::int64_t{area.high.y} - area.low.y + 1);
}

bool fits(const CellRectangle& area) {
  return area.high.x - area.low.x < OpenGrid::kMaxSide && area.high.y - area.low.y < OpenGrid::kMaxSide &&
         cells_of(area) <= RobotGrids::kMaxCells;
}

CellRectangle grown(const CellRectangle& area, int by) {
  return {{area.low.x - by, area.low.y - by}, {area.high.x + by, area.high.y + by}};
}

bool holds(const CellRectangle& area, const CellRectangle& other) {
  return area.holds(other.low) && area.holds(other.high);
}

}  // namespace

RobotGrid::RobotGrid(const Terrain& terrain, double radius, const CellRectangle& area)
    : area_(area), space_(terrain, radius) {
  OpenGrid open(area.high.x - area.low.x + 1, area.high.y - area.low.y + 1);
  for (std::int32_t y = area.low.y; y <= area.high.y; y += FreeSpace::kSide) {
    for (std::int32_t x = area.low.x; x <= area.high.x; x += FreeSpace::kSide) {
      const FreeSpace::Rows& rows = space_.open_rows(FreeSpace::tile_of({x, y}));
      for (int row = 0; row < FreeSpace::kSide; ++row) {
        for (std::uint64_t bits = rows[static_cast<std::size_t>(row)]; bits != 0; bits &= bits - 1) {
          open.set(local({x + std::countr_zero(bits), y + row}), true);
        }
      }
    }
  }
  paths_ = std::make_unique<GridPaths>(std::move(open), GridPaths::kReach, [this](Cell a, Cell b) {
    return space_.sees(centre_of(global(a)), centre_of(global(b)));
  });
}

void RobotGrid::follow(std::span<const BrickIndex> columns) {
  std::set<Cell> tiles;
  for (const BrickIndex column : columns) {
    space_.follow(column);
    const Cell low = FreeSpace::tile_of({column.x * 8 - reach(), column.y * 8 - reach()});
    const Cell high = FreeSpace::tile_of({column.x * 8 + 7 + reach(), column.y * 8 + 7 + reach()});
    for (std::int32_t y = low.y; y <= high.y; ++y) {
      for (std::int32_t x = low.x; x <= high.x; ++x) tiles.insert({x, y});
    }
  }
  for (const Cell tile : tiles) {
    if (area_.holds({tile.x * FreeSpace::kSide, tile.y * FreeSpace::kSide})) take(tile);
  }
}

/// What has become another in a tile goes to the searches.
void RobotGrid::take(Cell tile) {
  const Cell corner = local({tile.x * FreeSpace::kSide, tile.y * FreeSpace::kSide});
  const FreeSpace::Rows& rows = space_.open_rows(tile);
  const OpenGrid& grid = paths_->grid();
  std::uint64_t columns = 0;
  Window window{{0, FreeSpace::kSide}, {0, -1}};
  for (int y = 0; y < FreeSpace::kSide; ++y) {
    const std::uint64_t changed = grid.row_from({corner.x, corner.y + y}) ^ rows[static_cast<std::size_t>(y)];
    if (changed == 0) continue;
    columns |= changed;
    window.low.y = std::min(window.low.y, y);
    window.high.y = y;
  }
  if (columns == 0) return;
  window.low.x = std::countr_zero(columns);
  window.high.x = 63 - std::countl_zero(columns);
  const Window at{{corner.x + window.low.x, corner.y + window.low.y},
                  {corner.x + window.high.x, corner.y + window.high.y}};
  paths_->update(at, [&](OpenGrid& open) {
    for (int y = window.low.y; y <= window.high.y; ++y) {
      const std::uint64_t row = rows[static_cast<std::size_t>(y)];
      for (int x = window.low.x; x <= window.high.x; ++x) open.set({corner.x + x, corner.y + y}, (row >> x & 1) != 0);
    }
  });
}

RobotGrids::RobotGrids(const Terrain& terrain, int slack) : terrain_(terrain), slack_(slack) {
  terrain.grid().cells().for_each_brick(
      [&](BrickIndex column, const Brick&) { areas_.follow(terrain_.grid(), column); });
}

std::shared_ptr<RobotGrid> RobotGrids::at(double radius, Ignoring ignoring, const CellRectangle& area) {
  if (!fits(area)) return nullptr;
  const auto is_it = [&](const Kept& kept) {
    return kept.radius == radius && kept.ignoring == ignoring && holds(kept.grid->area(), area);
  };
  const auto it = std::find_if(kept_.begin(), kept_.end(), is_it);
  if (it != kept_.end()) {
    it->unused = 0;
    std::rotate(it, it + 1, kept_.end());
    return kept_.back().grid;
  }
  CellRectangle wanted = grown(area, slack_ * Areas::kTile);
  if (!fits(wanted)) wanted = area;
  std::erase_if(kept_, [&](const Kept& kept) {
    return kept.radius == radius && kept.ignoring == ignoring && holds(wanted, kept.grid->area());
  });
  kept_.push_back({radius, ignoring, 0, std::make_shared<RobotGrid>(terrain_.without(ignoring), radius, wanted)});
  made_ += cells_of(wanted);
  std::int64_t cells = 0;
  std::size_t first = kept_.size();
  while (first > 0 && kept_.size() - first < kMaxKept) {
    cells += cells_of(kept_[first - 1].grid->area());
    if (cells > kMaxKeptCells && first < kept_.size()) break;
    --first;
  }
  kept_.erase(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(first));
  return kept_.back().grid;
}

void RobotGrids::follow(std::span<const BrickIndex> columns) {
  for (const BrickIndex column : columns) areas_.follow(terrain_.grid(), column);
  // What is unknown, but within what was seen, may have become more far from all that changed.
  const bool saw_more = std::exchange(seen_, terrain_.grid().seen()) != seen_;
  std::erase_if(kept_, [&](Kept& kept) {
    return ++kept.unused > kMaxUnused || (saw_more && kept.ignoring == Ignoring::kUnobserved);
  });
  for (const Kept& kept : kept_) kept.grid->follow(columns);
}

}  // namespace concord
