#include "planner/lattice/components.hpp"

#include <algorithm>
#include <numeric>

namespace concord {
namespace {

/// Halves paths as it goes.
template <class Parents, class Index>
Index find_root(Parents& parent, Index i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/// The lower one stays the root: what is labelled does not depend on the order.
template <class Parents, class Index>
void join(Parents& parent, Index a, Index b) {
  a = find_root(parent, a);
  b = find_root(parent, b);
  if (a != b) parent[std::max(a, b)] = std::min(a, b);
}

/// The first cells of the runs of ones.
std::uint64_t starts_of(std::uint64_t row) { return row & ~(row << 1); }

}  // namespace

std::uint16_t Components::Tile::part_at(int x, int y) const {
  const std::uint64_t up_to = ~std::uint64_t{0} >> (63 - x);
  return part[first_run[y] + std::popcount(starts_of(rows[y]) & up_to) - 1];
}

Components::Components(const OpenGrid& grid)
    : grid_(grid), across_((grid.width() + kTile - 1) / kTile), up_((grid.height() + kTile - 1) / kTile) {
  tiles_.resize(static_cast<std::size_t>(across_) * up_);
  for (int ty = 0; ty < up_; ++ty) {
    for (int tx = 0; tx < across_; ++tx) join_runs(tx, ty);
  }
  for (int ty = 0; ty < up_; ++ty) {
    for (int tx = 0; tx < across_; ++tx) link(tx, ty);
  }
}

void Components::update(const Window& window) {
  const int x0 = std::max(window.low.x, 0) / kTile;
  const int y0 = std::max(window.low.y, 0) / kTile;
  const int x1 = std::min(window.high.x, grid_.width() - 1);
  const int y1 = std::min(window.high.y, grid_.height() - 1);
  if (x1 < 0 || y1 < 0) return;
  for (int ty = y0; ty <= y1 / kTile; ++ty) {
    for (int tx = x0; tx <= x1 / kTile; ++tx) join_runs(tx, ty);
  }
  for (int ty = std::max(y0 - 1, 0); ty <= y1 / kTile; ++ty) {
    for (int tx = std::max(x0 - 1, 0); tx <= x1 / kTile; ++tx) link(tx, ty);
  }
  is_joined_ = false;
}

void Components::join_runs(int tx, int ty) {
  Tile& tile = tiles_[static_cast<std::size_t>(ty) * across_ + tx];
  std::vector<std::uint16_t> parent;
  const int height = std::min(kTile, grid_.height() - ty * kTile);
  std::uint64_t below = 0;
  std::size_t run_below = 0;
  for (int y = 0; y < kTile; ++y) {
    const std::uint64_t row = y < height ? grid_.rows().word_from(ty * kTile + y + 1, tx * kTile + 1) : 0;
    tile.rows[y] = row;
    tile.first_run[y] = static_cast<std::uint16_t>(parent.size());
    const std::size_t first_below = run_below;
    run_below = parent.size();
    for (std::uint64_t starts = starts_of(row); starts != 0; starts &= starts - 1) {
      const auto run = static_cast<std::uint16_t>(parent.size());
      parent.push_back(run);
      const int begin = std::countr_zero(starts);
      const std::uint64_t cells = (~std::uint64_t{0} >> (64 - std::countr_one(row >> begin))) << begin;
      // One run below is met where it begins to overlap.
      for (std::uint64_t met = starts_of(below & cells); met != 0; met &= met - 1) {
        const std::uint64_t up_to = ~std::uint64_t{0} >> (63 - std::countr_zero(met));
        const auto other = first_below + static_cast<std::size_t>(std::popcount(starts_of(below) & up_to)) - 1;
        join(parent, run, static_cast<std::uint16_t>(other));
      }
    }
    below = row;
  }
  tile.part.assign(parent.size(), 0);
  tile.parts = 0;
  for (std::size_t run = 0; run < parent.size(); ++run) {
    const std::uint16_t root = find_root(parent, static_cast<std::uint16_t>(run));
    tile.part[run] = root == run ? static_cast<std::uint16_t>(tile.parts++) : tile.part[root];
  }
}

/// To the tiles on the right and above.
void Components::link(int tx, int ty) {
  Tile& tile = tile_at(tx, ty);
  tile.right.clear();
  tile.above.clear();
  const auto add = [](std::vector<Link>& links, Link link) {
    const auto same = [&](const Link& l) { return l.here == link.here && l.there == link.there; };
    if (std::none_of(links.begin(), links.end(), same)) links.push_back(link);
  };
  if (tx + 1 < across_) {
    const Tile& other = tile_at(tx + 1, ty);
    const int x = (tx + 1) * kTile;  // of the column right of the border, and with its own border the line left of it
    const int height = std::min(kTile, grid_.height() - ty * kTile);
    const std::uint64_t both = grid_.columns().word_from(x, ty * kTile + 1) &
                               grid_.columns().word_from(x + 1, ty * kTile + 1) & ~std::uint64_t{0} >> (64 - height);
    for (std::uint64_t met = starts_of(both); met != 0; met &= met - 1) {
      const int y = std::countr_zero(met);
      add(tile.right, {tile.part_at(kTile - 1, y), other.part_at(0, y)});
    }
  }
  if (ty + 1 < up_) {
    const Tile& other = tile_at(tx, ty + 1);
    for (std::uint64_t met = starts_of(tile.rows[kTile - 1] & other.rows[0]); met != 0; met &= met - 1) {
      const int x = std::countr_zero(met);
      add(tile.above, {tile.part_at(x, kTile - 1), other.part_at(x, 0)});
    }
  }
}

void Components::join_tiles() {
  std::uint32_t count = 0;
  for (Tile& tile : tiles_) {
    tile.offset = count;
    count += tile.parts;
  }
  parent_.resize(count);
  std::iota(parent_.begin(), parent_.end(), 0U);
  for (int ty = 0; ty < up_; ++ty) {
    for (int tx = 0; tx < across_; ++tx) {
      const Tile& tile = tile_at(tx, ty);
      for (const Link& link : tile.right)
        join(parent_, tile.offset + link.here, tile_at(tx + 1, ty).offset + link.there);
      for (const Link& link : tile.above)
        join(parent_, tile.offset + link.here, tile_at(tx, ty + 1).offset + link.there);
    }
  }
  is_joined_ = true;
}

std::uint32_t Components::part_of(Cell cell) const {
  const Tile& tile = tiles_[static_cast<std::size_t>(cell.y / kTile) * across_ + cell.x / kTile];
  return tile.offset + tile.part_at(cell.x % kTile, cell.y % kTile);
}

bool Components::connected(Cell a, Cell b) {
  if (!is_joined_) join_tiles();
  return find_root(parent_, part_of(a)) == find_root(parent_, part_of(b));
}

}  // namespace concord
