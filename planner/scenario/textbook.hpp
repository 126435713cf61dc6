#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "planner/lattice/open_grid.hpp"

namespace concord {

/// A* as textbooks have it, over a plain array of cells with a binary heap and the octile distance as heuristic: what
/// searches are measured by. Cells are not cleared between queries, only counted; ties go to the larger cost so far.
class TextbookAStar {
 public:
  explicit TextbookAStar(const OpenGrid& grid);

  /// The cost in kStraight and kDiagonal of the shortest path over eight directions, a diagonal only if both cells
  /// beside it are open.
  [[nodiscard]] std::optional<std::int64_t> find(Cell start, Cell goal);

 private:
  struct Node {
    std::int64_t cost = 0;
    std::uint32_t query = 0;
    std::int32_t parent = -1;
    bool is_closed = false;
  };

  int width_, height_;
  std::vector<std::uint8_t> open_;
  std::vector<Node> nodes_;
  std::uint32_t query_ = 0;
};

}  // namespace concord
