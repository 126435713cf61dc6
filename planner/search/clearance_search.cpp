#include "planner/search/clearance_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "planner/search/jump_graph.hpp"

namespace concord {
namespace {

constexpr std::int64_t kStraightStep = ClearanceSearch::kStraightStep, kDiagonalStep = ClearanceSearch::kDiagonalStep;

std::int64_t step_cost(int factors, bool is_diagonal) {
  return (is_diagonal ? kDiagonalStep : kStraightStep) * factors / (2 * ClearanceCost::kUnit);
}

/// By the nine cells around one, row by row from the lower left: the directions that a step can take.
constexpr std::array<std::uint8_t, 512> kSteps = [] {
  std::array<std::uint8_t, 512> steps{};
  for (unsigned around = 0; around < 512; ++around) {
    const auto is_open = [&](int dx, int dy) { return (around >> ((dy + 1) * 3 + dx + 1) & 1) != 0; };
    for (int d = 0; d < 8; ++d) {
      const int dx = kDx[static_cast<std::size_t>(d)];
      const int dy = kDy[static_cast<std::size_t>(d)];
      if (is_open(dx, dy) && is_open(dx, 0) && is_open(0, dy)) steps[around] |= static_cast<std::uint8_t>(1U << d);
    }
  }
  return steps;
}();

/// Bits x to x + 2 of a line.
unsigned three(const BitLines& lines, int line, int x) {
  const std::uint64_t* words = lines.line(line);
  const int shift = x & 63;
  std::uint64_t bits = words[x >> 6] >> shift;
  if (shift > 61) bits |= words[(x >> 6) + 1] << (64 - shift);
  return static_cast<unsigned>(bits & 7);
}

}  // namespace

ClearanceCost::ClearanceCost(int reach) {
  for (int squared = 0; squared <= reach * reach; ++squared) {
    const double near = 1 - std::sqrt(squared) / reach;
    factors_.push_back(static_cast<std::uint8_t>(kUnit + std::lround(kUnit * kWorst * near * near)));
  }
}

ClearanceSearch::ClearanceSearch(const OpenGrid& grid, const DistanceField& field, SightRule also)
    : grid_(grid),
      field_(field),
      also_(std::move(also)),
      costs_(field.reach()),
      states_(static_cast<std::size_t>(grid.width()) * static_cast<std::size_t>(grid.height())),
      buckets_(kBuckets) {}

void ClearanceSearch::heed(const ExtraCosts* extra) {
  extra_ = extra;
  buckets_.resize(extra_ == nullptr ? kBuckets : kBucketsWithExtra);
}

std::int64_t ClearanceSearch::at_least(Cell from, Cell to) {
  const std::int64_t dx = std::abs(std::int64_t{from.x} - to.x);
  const std::int64_t dy = std::abs(std::int64_t{from.y} - to.y);
  return std::max(dx, dy) * kStraightStep + std::min(dx, dy) * (kDiagonalStep - kStraightStep);
}

std::uint32_t ClearanceSearch::index_of(Cell cell) const {
  return static_cast<std::uint32_t>(cell.y) * static_cast<std::uint32_t>(grid_.width()) +
         static_cast<std::uint32_t>(cell.x);
}

Cell ClearanceSearch::cell_at(std::uint32_t index) const {
  const auto width = static_cast<std::uint32_t>(grid_.width());
  return {static_cast<std::int32_t>(index % width), static_cast<std::int32_t>(index / width)};
}

void ClearanceSearch::begin(Cell goal) {
  if (++query_ == 0) {
    states_.clear();
    query_ = 1;
  }
  for (std::vector<std::uint32_t>& bucket : buckets_) bucket.clear();
  waiting_ = 0;
  goal_ = goal;
}

void ClearanceSearch::reach(std::uint32_t index, Cell cell, std::int64_t cost, int direction) {
  State& state = states_[index];
  if (state.query == query_ && cost >= state.cost) return;
  const std::int64_t total = cost + at_least(cell, goal_);
  if (total >= limit_) return;
  state = {cost, query_, static_cast<std::uint8_t>(direction), false};
  bucket(total).push_back(index);
  ++waiting_;
}

void ClearanceSearch::expand(std::uint32_t index, Cell cell) {
  unsigned around = 0;
  for (int row = 0; row < 3; ++row) around |= three(grid_.rows(), cell.y + row, cell.x) << (3 * row);
  const std::int64_t cost = states_[index].cost;
  const int factor = factor_at(cell);
  for (unsigned steps = kSteps[around]; steps != 0; steps &= steps - 1) {
    const int d = std::countr_zero(steps);
    const Cell next{cell.x + kDx[static_cast<std::size_t>(d)], cell.y + kDy[static_cast<std::size_t>(d)]};
    reach(index_of(next), next, cost + step_cost(factor + factor_at(next), d >= 4), d);
  }
}

std::optional<ClearPath> ClearanceSearch::find(Cell start, Cell goal, const Limits& limits) {
  expanded_ = 0;
  if (!grid_.is_open(start) || !grid_.is_open(goal)) return std::nullopt;
  begin(goal);
  limit_ = limits.cost;
  least_ = at_least(start, goal);
  reach(index_of(start), start, 0, 0);
  while (waiting_ > 0) {
    std::vector<std::uint32_t>& next = bucket(least_);
    if (next.empty()) {
      ++least_;
      continue;
    }
    const std::uint32_t index = next.back();
    next.pop_back();
    --waiting_;
    State& state = states_[index];
    if (state.is_done) continue;
    if (expanded_ == limits.expanded) return std::nullopt;
    state.is_done = true;
    ++expanded_;
    const Cell cell = cell_at(index);
    if (cell == goal) return shorten(trace(start, goal));
    expand(index, cell);
  }
  return std::nullopt;
}

std::vector<Cell> ClearanceSearch::trace(Cell start, Cell goal) const {
  std::vector<Cell> cells{goal};
  while (cells.back() != start) {
    const Cell at = cells.back();
    const std::size_t d = states_[index_of(at)].came_by;
    cells.push_back({at.x - kDx[d], at.y - kDy[d]});
  }
  std::reverse(cells.begin(), cells.end());
  return cells;
}

std::int64_t ClearanceSearch::step(Cell from, Cell to) const {
  return step_cost(factor_at(from) + factor_at(to), from.x != to.x && from.y != to.y);
}

std::int64_t ClearanceSearch::cost(const std::vector<Cell>& cells) const {
  std::int64_t sum = 0;
  for (std::size_t i = 1; i < cells.size(); ++i) sum += step(cells[i - 1], cells[i]);
  return sum;
}

}  // namespace concord
