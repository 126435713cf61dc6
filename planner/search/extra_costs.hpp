#pragma once

#include <cstdint>
#include <vector>

#include "planner/lattice/open_grid.hpp"

namespace concord {

/// What it costs besides to be in a cell of a grid: so many times what a free one far from everything costs.
class ExtraCosts {
 public:
  static constexpr int kMost = 15;

  /// None anywhere.
  explicit ExtraCosts(const OpenGrid& grid)
      : width_(static_cast<std::size_t>(grid.width())), costs_(width_ * static_cast<std::size_t>(grid.height())) {}

  [[nodiscard]] bool holds(Cell cell) const {
    return cell.x >= 0 && cell.y >= 0 && static_cast<std::size_t>(cell.x) < width_ && index_of(cell) < costs_.size();
  }
  /// @pre the grid holds the cell; for `set`, 0 <= cost <= kMost.
  [[nodiscard]] int at(Cell cell) const { return costs_[index_of(cell)]; }
  void set(Cell cell, int cost) {
    costs_[index_of(cell)] = static_cast<std::uint8_t>(cost);
    has_any_ = has_any_ || cost != 0;
  }
  /// Whether any cell ever had one.
  [[nodiscard]] bool has_any() const { return has_any_; }

 private:
  [[nodiscard]] std::size_t index_of(Cell cell) const {
    return static_cast<std::size_t>(cell.y) * width_ + static_cast<std::size_t>(cell.x);
  }

  std::size_t width_;
  std::vector<std::uint8_t> costs_;
  bool has_any_ = false;
};

}  // namespace concord
