#pragma once

#include <cstdint>

#include "planner/lattice/bit_lines.hpp"
#include "planner/lattice/cell.hpp"

namespace concord {

/// A rectangle of cells with corner (0, 0), each open or blocked, kept by rows and by columns. What lies outside is
/// blocked.
class OpenGrid {
 public:
  /// Two more fit into 16 bits, for the border.
  static constexpr int kMaxSide = 65'533;
  static constexpr std::int64_t kMaxCells = 100'000'000;

  /// All cells blocked. @pre 1 <= width, height <= kMaxSide, width * height <= kMaxCells.
  OpenGrid(int width, int height);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] bool holds(Cell cell) const {
    return cell.x >= 0 && cell.y >= 0 && cell.x < width_ && cell.y < height_;
  }
  [[nodiscard]] bool is_open(Cell cell) const { return holds(cell) && rows_.test(cell.y + 1, cell.x + 1); }

  /// The 64 cells from `cell` on along x; blocked ones beyond the grid. @pre holds(cell).
  [[nodiscard]] std::uint64_t row_from(Cell cell) const { return rows_.word_from(cell.y + 1, cell.x + 1); }
  /// @pre holds(cell).
  void set(Cell cell, bool open) {
    rows_.assign(cell.y + 1, cell.x + 1, open);
    columns_.assign(cell.x + 1, cell.y + 1, open);
  }

  /// Line y + 1, bit x + 1: there is a blocked line or bit on every side, so that scans end without being told where.
  [[nodiscard]] const BitLines& rows() const { return rows_; }
  /// Line x + 1, bit y + 1.
  [[nodiscard]] const BitLines& columns() const { return columns_; }

 private:
  int width_, height_;
  BitLines rows_, columns_;
};

}  // namespace concord
