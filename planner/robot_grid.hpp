#pragma once

#include <memory>
#include <span>
#include <vector>

#include "planner/areas.hpp"
#include "planner/free_space.hpp"
#include "planner/search/grid_paths.hpp"

namespace concord {

/// A rectangle of the terrain as a round robot of one radius sees it: the cells at whose centre its disc may be
/// (`FreeSpace`), and all searches over them, kept up with what changes.
class RobotGrid {
 public:
  /// `radius` in cells. `area` begins and ends at borders of tiles of 64 cells, and is within OpenGrid's bounds.
  RobotGrid(const Terrain& terrain, double radius, const CellRectangle& area);
  RobotGrid(const RobotGrid&) = delete;
  RobotGrid& operator=(const RobotGrid&) = delete;

  /// The ground of these columns of bricks has changed.
  void follow(std::span<const BrickIndex> columns);

  [[nodiscard]] FreeSpace& space() { return space_; }
  [[nodiscard]] GridPaths& paths() { return *paths_; }
  [[nodiscard]] const CellRectangle& area() const { return area_; }
  /// Cells of `paths`, which begin at (0, 0), and those of the map.
  [[nodiscard]] Cell local(Cell cell) const { return {cell.x - area_.low.x, cell.y - area_.low.y}; }
  [[nodiscard]] Cell global(Cell cell) const { return {cell.x + area_.low.x, cell.y + area_.low.y}; }
  /// No change further than so many cells away matters to a robot.
  [[nodiscard]] int reach() const { return space_.reach() + 1; }

 private:
  void take(Cell tile);

  CellRectangle area_;
  FreeSpace space_;
  std::unique_ptr<GridPaths> paths_;
};

/// The rectangles that were asked for of late, for robots of any radius.
class RobotGrids {
 public:
  /// Of one rectangle: 250 m x 250 m at 5 cm.
  static constexpr std::int64_t kMaxCells = 25'000'000;
  /// Of all that are kept, beyond the last.
  static constexpr std::int64_t kMaxKeptCells = 40'000'000;
  static constexpr std::size_t kMaxKept = 16;
  /// What is not asked for through so many changes is not kept up any longer.
  static constexpr int kMaxUnused = 200;

  /// `slack`: tiles by which a rectangle is larger than what it is asked for, so that a map that grows does not make it
  /// begin anew each time.
  RobotGrids(const Terrain& terrain, int slack);

  /// Null: `area` is larger than kMaxCells. Of two calls the first's is as it was, but out of date after `follow`
  /// unless it is asked for again.
  [[nodiscard]] std::shared_ptr<RobotGrid> at(double radius, Ignoring ignoring, const CellRectangle& area);
  [[nodiscard]] Areas& areas() { return areas_; }
  [[nodiscard]] const Terrain& terrain() const { return terrain_; }

  void follow(std::span<const BrickIndex> columns);
  /// Anything may have changed.
  void clear() { kept_.clear(); }
  /// Cells of rectangles that were made so far: what it took.
  [[nodiscard]] std::int64_t made() const { return made_; }

 private:
  struct Kept {
    double radius;
    Ignoring ignoring;
    int unused;  ///< changes since it was asked for
    std::shared_ptr<RobotGrid> grid;
  };

  Terrain terrain_;
  int slack_;
  Areas areas_;
  std::vector<Kept> kept_;  ///< the last that was asked for comes last
  std::int64_t made_ = 0;
  Window seen_;  ///< by the grid, at the last change
};

}  // namespace concord
