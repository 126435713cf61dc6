#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "planner/lattice/distance_field.hpp"
#include "planner/search/extra_costs.hpp"
#include "planner/search/sight_rule.hpp"
#include "planner/search/zeroed.hpp"

namespace concord {

/// A path that keeps away from what is blocked.
struct ClearPath {
  std::int64_t cost = 0;    ///< of the cells that were found, before they were shortened; in 1/128 of a free cell
  double length = 0;        ///< cells
  std::vector<Cell> cells;  ///< as they were found, each a neighbour of the one before
  std::vector<Cell> turns;  ///< straight lines between cell centres that touch open cells only
  std::int64_t expanded = 0;
  bool is_fast = false;            ///< not looked for away from anything: see GridPaths::clear_or_fast
  std::vector<std::int64_t> sums;  ///< by cell, what the path costs so far
  std::vector<std::size_t> at;     ///< by turn, which cell it is
};

/// What it costs to be near something blocked: a step costs its length times a factor of 1 out of reach that grows to
/// `1 + kWorst` beside a blocked cell, with the square of how near it is. In sixteenths.
class ClearanceCost {
 public:
  static constexpr int kUnit = 16;
  static constexpr int kWorst = 2;

  explicit ClearanceCost(int reach);
  [[nodiscard]] int factor(std::uint16_t squared) const { return factors_[squared]; }

 private:
  std::vector<std::uint8_t> factors_;  ///< by squared distance
};

/// The cheapest path over open cells in eight directions by A* (a diagonal only if both cells beside it are open), with
/// whole costs in buckets; ties go to what was found last. Then each stretch that an exact straight line can replace
/// is replaced, if neither the least distance of its cells to what is blocked nor its cost gets worse.
class ClearanceSearch {
 public:
  /// What steps between cells far from everything cost: as 1 to the square root of 2, to a ten-thousandth.
  static constexpr std::int64_t kStraightStep = 128, kDiagonalStep = 181;

  /// Both must outlive this and be up to date when it is asked. A straight line must be seen over the grid and
  /// `also`, if there is such a rule.
  ClearanceSearch(const OpenGrid& grid, const DistanceField& field, SightRule also = {});

  /// Cells cost that much more from now on. Null: none does. It must outlive this.
  void heed(const ExtraCosts* extra);

  /// What a search may find and take.
  struct Limits {
    std::int64_t cost = std::numeric_limits<std::int64_t>::max();      ///< a path must cost less
    std::int64_t expanded = std::numeric_limits<std::int64_t>::max();  ///< cells
  };

  /// Nothing where there is no way within the limits, and where either end is blocked or beyond the grid.
  [[nodiscard]] std::optional<ClearPath> find(Cell start, Cell goal) { return find(start, goal, {}); }
  [[nodiscard]] std::optional<ClearPath> find(Cell start, Cell goal, const Limits& limits);

  /// What `find` makes of the cells that it found. @pre they are open, each a neighbour of the one before.
  [[nodiscard]] ClearPath shorten(std::vector<Cell> cells) const;

  /// Cells that the last search looked at.
  [[nodiscard]] std::int64_t expanded() const { return expanded_; }

  /// What a path between two cells costs at least.
  [[nodiscard]] static std::int64_t at_least(Cell from, Cell to);

  /// The same where the cells before `old.cells[first]` and behind `old.cells[last]` are those of `old`, and nothing
  /// there costs more than it did: its straight lines stay as far as they do not come near `changed`.
  [[nodiscard]] ClearPath shorten_again(std::vector<Cell> cells, const ClearPath& old, std::size_t first,
                                        std::size_t last, const Window& changed) const;

  /// Costs have changed between two cells of the path, both included, and nowhere else on it.
  void follow(ClearPath& path, std::size_t first, std::size_t last) const;

  /// What the cells cost as they are. @pre see shorten.
  [[nodiscard]] std::int64_t cost(const std::vector<Cell>& cells) const;

 private:
  /// Powers of two, more than a step and what it leads away from the goal can cost.
  static constexpr std::size_t kBuckets = 1024, kBucketsWithExtra = 4096;
  struct State {
    std::int64_t cost;
    std::uint32_t query;
    std::uint8_t came_by;  ///< direction
    bool is_done;
  };

  void begin(Cell goal);
  void reach(std::uint32_t index, Cell cell, std::int64_t cost, int direction);
  void expand(std::uint32_t index, Cell cell);
  [[nodiscard]] std::uint32_t index_of(Cell cell) const;
  [[nodiscard]] Cell cell_at(std::uint32_t index) const;
  [[nodiscard]] std::vector<Cell> trace(Cell start, Cell goal) const;
  [[nodiscard]] int factor_at(Cell cell) const {
    const int factor = costs_.factor(field_.squared(cell));
    return extra_ == nullptr ? factor : factor + ClearanceCost::kUnit * extra_->at(cell);
  }
  [[nodiscard]] std::vector<std::uint32_t>& bucket(std::int64_t total) {
    return buckets_[static_cast<std::size_t>(total) & (buckets_.size() - 1)];
  }
  [[nodiscard]] std::int64_t step(Cell from, Cell to) const;
  [[nodiscard]] std::int64_t line_cost(Cell from, Cell to) const;
  [[nodiscard]] int least_on_line(Cell from, Cell to) const;
  void sum_up(ClearPath& path, std::size_t first, std::size_t last) const;
  void draw_lines(ClearPath& path, std::size_t from, std::size_t last) const;

  const OpenGrid& grid_;
  const DistanceField& field_;
  SightRule also_;
  ClearanceCost costs_;
  const ExtraCosts* extra_ = nullptr;
  Zeroed<State> states_;
  std::uint32_t query_ = 0;
  std::vector<std::vector<std::uint32_t>> buckets_;
  std::int64_t least_ = 0;    ///< total cost of the present bucket
  std::int64_t waiting_ = 0;  ///< in all buckets
  Cell goal_;
  std::int64_t limit_ = 0;  ///< a path costs less
  std::int64_t expanded_ = 0;
};

}  // namespace concord
