#include "planner/search.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <memory>
#include <queue>
#include <tuple>
#include <unordered_map>

namespace concord {
namespace {

constexpr std::int64_t kUnreached = std::numeric_limits<std::int64_t>::max();
constexpr std::uint8_t kFromAnchor = 8;
constexpr std::size_t kBlockCells = std::size_t{FreeSpace::kSide} * FreeSpace::kSide;

struct Step {
  int dx, dy;
};
constexpr std::array<Step, 8> kSteps{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};

/// What the search knows of 64 x 64 cells.
struct Block {
  explicit Block(const FreeSpace::Rows& rows) : open(rows) {
    cost.fill(kUnreached);
    closed.fill(0);
    around.fill(nullptr);
  }

  const FreeSpace::Rows& open;
  FreeSpace::Rows closed;
  std::array<std::int64_t, kBlockCells> cost;
  std::array<std::uint8_t, kBlockCells> came_by;  ///< index into kSteps, or kFromAnchor
  std::array<Block*, 9> around;                   ///< neighbours that have been looked up; [4] is unused
};

int local_of(Cell cell) { return (cell.x & 63) | (cell.y & 63) << 6; }

class AStar {
 public:
  AStar(FreeSpace& space, std::span<const Anchor> goals) : space_(space), goals_(goals) {}

  CellPath run(std::span<const Anchor> starts, std::int64_t max_expanded) {
    for (const Anchor& start : starts) reach(*block_at(start.cell), start.cell, start.cost, kFromAnchor);
    CellPath path;
    while (!queue_.empty()) {
      const Entry top = queue_.top();
      queue_.pop();
      // An entry for the goal itself: its total is settled, and no other can be cheaper.
      if (top.is_arrival) {
        path.status = CellPath::Status::kFound;
        path.cost = top.total;
        path.cells = trace(top.cell);
        return path;
      }
      Block& block = *block_at(top.cell);
      std::uint64_t& closed = block.closed[top.cell.y & 63];
      const std::uint64_t bit = std::uint64_t{1} << (top.cell.x & 63);
      if ((closed & bit) != 0) continue;
      closed |= bit;
      if (path.expanded == max_expanded) {
        path.status = CellPath::Status::kGaveUp;
        break;
      }
      ++path.expanded;
      expand(block, top.cell);
    }
    path.reached = reached();
    return path;
  }

 private:
  struct Entry {
    std::int64_t total, remaining;
    Cell cell;
    bool is_arrival;

    /// The queue gives out its largest: the least total, then the least remaining, then the lowest y and x.
    bool operator<(const Entry& other) const {
      return std::tie(total, remaining, cell.y, cell.x, other.is_arrival) >
             std::tie(other.total, other.remaining, other.cell.y, other.cell.x, is_arrival);
    }
  };

  Block* block_at(Cell cell) {
    const Cell tile = FreeSpace::tile_of(cell);
    if (last_ != nullptr && tile == last_tile_) return last_;
    std::unique_ptr<Block>& block = blocks_[tile];
    if (block == nullptr) block = std::make_unique<Block>(space_.open_rows(tile));
    last_tile_ = tile;
    last_ = block.get();
    return last_;
  }

  /// The block that holds `cell`, which is `block`'s or in one beside it.
  Block& beside(Block& block, Cell tile, Cell cell) {
    const Cell other = FreeSpace::tile_of(cell);
    if (other == tile) return block;
    Block*& found = block.around[(other.x - tile.x + 1) + 3 * (other.y - tile.y + 1)];
    if (found == nullptr) found = block_at(cell);
    return *found;
  }

  [[nodiscard]] std::int64_t to_go(Cell cell) const {
    std::int64_t least = kUnreached;
    for (const Anchor& goal : goals_) {
      const std::int64_t dx = std::abs(std::int64_t{cell.x} - goal.cell.x);
      const std::int64_t dy = std::abs(std::int64_t{cell.y} - goal.cell.y);
      const std::int64_t both = std::min(dx, dy);
      least = std::min(least, goal.cost + both * kDiagonal + (std::max(dx, dy) - both) * kStraight);
    }
    return least;
  }

  void reach(Block& block, Cell cell, std::int64_t cost, std::uint8_t step) {
    const int local = local_of(cell);
    if (cost >= block.cost[local]) return;
    block.cost[local] = cost;
    block.came_by[local] = step;
    const std::int64_t remaining = to_go(cell);
    queue_.push({cost + remaining, remaining, cell, false});
  }

  void expand(Block& block, Cell cell) {
    const std::int64_t cost = block.cost[local_of(cell)];
    for (const Anchor& goal : goals_) {
      if (goal.cell == cell) queue_.push({cost + goal.cost, 0, cell, true});
    }
    const Cell tile = FreeSpace::tile_of(cell);
    std::array<bool, 4> open;
    for (int i = 0; i < 8; ++i) {
      const bool is_diagonal = i >= 4;
      if (is_diagonal && !(open[i - 4] && open[(i - 3) & 3])) continue;
      const Cell next{cell.x + kSteps[i].dx, cell.y + kSteps[i].dy};
      Block& other = beside(block, tile, next);
      const std::uint64_t bit = std::uint64_t{1} << (next.x & 63);
      const bool is_open = (other.open[next.y & 63] & bit) != 0;
      if (!is_diagonal) open[i] = is_open;
      if (!is_open || (other.closed[next.y & 63] & bit) != 0) continue;
      reach(other, next, cost + (is_diagonal ? kDiagonal : kStraight), static_cast<std::uint8_t>(i));
    }
  }

  std::vector<Cell> trace(Cell cell) {
    std::vector<Cell> cells;
    for (;;) {
      cells.push_back(cell);
      const std::uint8_t step = block_at(cell)->came_by[local_of(cell)];
      if (step == kFromAnchor) break;
      cell = {cell.x - kSteps[step].dx, cell.y - kSteps[step].dy};
    }
    std::reverse(cells.begin(), cells.end());
    return cells;
  }

  /// The cells that were expanded. Beside them the search looked at their neighbours and at the straight lines from a
  /// start or goal near by.
  [[nodiscard]] Region reached() const {
    Region region(space_.reach() + 4);
    for (const auto& [tile, block] : blocks_) {
      std::uint64_t columns = 0;
      for (int y = 0; y < FreeSpace::kSide; ++y) {
        for (int x = 0; x < 8; ++x) {
          if ((block->closed[y] >> (8 * x) & 0xFF) != 0) columns |= std::uint64_t{1} << (x | (y & ~7));
        }
      }
      if (columns != 0) region.add(tile, columns);
    }
    return region;
  }

  FreeSpace& space_;
  std::span<const Anchor> goals_;
  std::unordered_map<Cell, std::unique_ptr<Block>, CellHash> blocks_;
  std::priority_queue<Entry> queue_;
  Cell last_tile_;
  Block* last_ = nullptr;
};

}  // namespace

CellPath find_path(FreeSpace& space, std::span<const Anchor> starts, std::span<const Anchor> goals,
                   std::int64_t max_expanded) {
  assert(!starts.empty() && !goals.empty());
  return AStar(space, goals).run(starts, max_expanded);
}

}  // namespace concord
