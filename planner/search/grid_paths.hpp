#pragma once

#include <memory>
#include <optional>

#include "planner/lattice/components.hpp"
#include "planner/search/any_angle.hpp"
#include "planner/search/clearance_search.hpp"
#include "planner/search/jump_search.hpp"

namespace concord {

/// Every cell of a path that goes straight or diagonally from turn to turn.
[[nodiscard]] std::vector<Cell> cells_of(const std::vector<Cell>& turns);

/// All ways to search one grid that changes: what they keep is made when it is first needed, and kept up to date.
class GridPaths {
 public:
  /// Within so many cells of what is blocked it costs to be.
  static constexpr int kReach = 10;

  /// A straight line of a path away from walls must be seen over the grid and `also`, if there is such a rule.
  explicit GridPaths(OpenGrid grid, int reach = kReach, SightRule also = {});
  GridPaths(const GridPaths&) = delete;
  GridPaths& operator=(const GridPaths&) = delete;

  /// What the grid alone decides; without these, the first question does it.
  void prepare_fast();
  void prepare_any_angle();
  void prepare_clear();

  [[nodiscard]] const OpenGrid& grid() const { return grid_; }
  /// Whether there is a way; said at once. False where either end is blocked or beyond the grid.
  [[nodiscard]] bool connected(Cell a, Cell b);
  /// Whether a path away from walls may go straight.
  [[nodiscard]] bool sees(Cell a, Cell b) const;

  /// The shortest over eight directions.
  [[nodiscard]] std::optional<OctilePath> fast(Cell start, Cell goal);
  /// The shortest at any angle; where that finds none over corners, the fast path with what can be left out left out.
  [[nodiscard]] std::optional<TautPath> any_angle(Cell start, Cell goal);
  /// One that keeps away from what is blocked.
  [[nodiscard]] std::optional<ClearPath> clear(Cell start, Cell goal, const ClearanceSearch::Limits& limits = {});
  /// The same; where looking at so many cells does not find it, the fast path with lines where they are as good.
  /// Nothing where there is no way only.
  [[nodiscard]] std::optional<ClearPath> clear_or_fast(Cell start, Cell goal, std::int64_t most_expanded);
  /// @pre prepare_clear.
  [[nodiscard]] ClearanceSearch& clearance() { return *clearance_; }
  [[nodiscard]] const DistanceField& field() const { return *field_; }

  /// Calls `change(grid)`, which may set the cells of `window` and no others. Returns whether it opened any.
  template <class Change>
  bool update(const Window& window, Change change) {
    const std::vector<bool> before = cells(window);
    change(grid_);
    return follow(window, before);
  }

 private:
  void prepare_components();
  [[nodiscard]] std::vector<bool> cells(const Window& window) const;
  bool follow(const Window& window, const std::vector<bool>& before);

  OpenGrid grid_;
  int reach_;
  SightRule also_;
  std::unique_ptr<Components> components_;
  std::unique_ptr<JumpGraph> graph_;
  std::unique_ptr<JumpSearch> jump_;
  std::unique_ptr<AnyAngleSearch> any_angle_;
  std::unique_ptr<DistanceField> field_;
  std::unique_ptr<ClearanceSearch> clearance_;
};

}  // namespace concord
