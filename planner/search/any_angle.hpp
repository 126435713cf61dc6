#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "planner/search/corner_sight.hpp"
#include "planner/search/open_list.hpp"

namespace concord {

/// A path in straight lines between cell centres; each touches open cells only, be it at a corner (lattice/sight.hpp).
struct TautPath {
  double length = 0;  ///< cells
  std::vector<Cell> turns;
  std::int64_t expanded = 0;  ///< corners
};

/// Any-angle paths: A* over the corners that can be seen from one another, found as the search comes by (Oh & Leong
/// 2017 keep them in a graph). Only taut turns are looked at, those around the blocked cell that makes the corner, so
/// what is looked through at a corner is a narrow view.
class AnyAngleSearch {
 public:
  explicit AnyAngleSearch(const OpenGrid& grid);
  /// Cells in `window` have changed.
  void update(const Window& window) { sight_.update(window); }

  /// Nothing where there is no way over corners, and where either end is blocked or beyond the grid.
  [[nodiscard]] std::optional<TautPath> find(Cell start, Cell goal);

 private:
  struct State {
    double length = 0;
    std::uint32_t query = 0;
    std::uint32_t parent = 0;
    bool is_done = false;
  };

  [[nodiscard]] std::uint32_t index_of(Cell cell) const {
    return static_cast<std::uint32_t>(cell.y) * static_cast<std::uint32_t>(grid_.width()) +
           static_cast<std::uint32_t>(cell.x);
  }
  [[nodiscard]] Cell cell_at(std::uint32_t index) const {
    const auto width = static_cast<std::uint32_t>(grid_.width());
    return {static_cast<std::int32_t>(index % width), static_cast<std::int32_t>(index / width)};
  }
  void reach(Cell cell, double length, std::uint32_t parent);
  void look_around(Cell start);
  void look_on(Cell at, Cell from);
  void look_between(Cell at, int dx, int dy, int corner, bool left);
  [[nodiscard]] TautPath trace(Cell last) const;

  const OpenGrid& grid_;
  CornerSight sight_;
  std::vector<State> states_;
  std::uint32_t query_ = 0;
  OpenList open_;
  std::vector<Cell> seen_;
  Cell start_, goal_;
  std::int64_t expanded_ = 0;
};

}  // namespace concord
