#include "planner/free_space.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace concord {
namespace {

/// Ones at [first, last] as far as they lie in 0 to 63.
std::uint64_t span_mask(int first, int last) {
  if (last < 0 || first > 63 || first > last) return 0;
  return ~std::uint64_t{0} << std::max(first, 0) & ~std::uint64_t{0} >> (63 - std::min(last, 63));
}

/// The right-most x of a disc of `radius` that is moved from `a` to `b`, on the horizontal line `y`;
/// minus infinity where the line misses it.
double rightmost_on(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double radius, double y) {
  double x = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& end : {a, b}) {
    const double dy = y - end.y();
    if (std::abs(dy) <= radius) x = std::max(x, end.x() + std::sqrt(radius * radius - dy * dy));
  }
  const Eigen::Vector2d d = b - a;
  if (d.y() == 0) return x;
  const Eigen::Vector2d normal = Eigen::Vector2d(d.y(), -d.x()) * ((d.y() > 0 ? radius : -radius) / d.norm());
  const double along = (y - a.y() - normal.y()) / d.y();
  if (along >= 0 && along <= 1) x = std::max(x, a.x() + normal.x() + along * d.x());
  return x;
}

/// The right-most x of the moved disc within the strip [y, y + 1]. Its right side is concave over y with the top level
/// with the right-most end, so the height nearest to that end decides.
double rightmost_in(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double radius, double y) {
  const double end = a.x() >= b.x() ? a.y() : b.y();
  return rightmost_on(a, b, radius, std::clamp(end, y, y + 1));
}

}  // namespace

Cell cell_of(const Eigen::Vector2d& p) {
  return {static_cast<std::int32_t>(std::floor(p.x())), static_cast<std::int32_t>(std::floor(p.y()))};
}

Eigen::Vector2d centre_of(Cell cell) { return {cell.x + 0.5, cell.y + 0.5}; }

FreeSpace::FreeSpace(const Terrain& terrain, double radius)
    : terrain_(terrain), radius_(std::max(radius - kTouch, kTouch)) {
  assert(std::isfinite(radius) && radius >= 0);
  // From a cell's centre to a cell d columns away there are d - 1/2 cells, to its own column none. In half cells:
  const auto gap = [](std::int64_t d) { return d == 0 ? std::int64_t{0} : (2 * d - 1) * (2 * d - 1); };
  const double limit = 4 * radius_ * radius_;
  auto dx = static_cast<int>(radius_ + 1);
  for (std::int64_t dy = 0; static_cast<double>(gap(dy)) <= limit; ++dy) {
    while (dx > 0 && static_cast<double>(gap(dx) + gap(dy)) > limit) --dx;
    widths_.push_back(dx);
  }
  reach_ = static_cast<int>(widths_.size()) - 1;
}

/// The rows of a column of bricks.
void FreeSpace::put(Rows& rows, BrickIndex column, std::uint64_t plane) {
  const int x = (column.x & 7) * 8;
  const int y = (column.y & 7) * 8;
  for (int i = 0; i < 8; ++i) {
    std::uint64_t& row = rows[static_cast<std::size_t>(y + i)];
    row = (row & ~(std::uint64_t{0xFF} << x)) | (plane >> (8 * i) & 0xFF) << x;
  }
}

void FreeSpace::follow(BrickIndex column) {
  const Ground now = terrain_.at(column);
  for (Layer* layer : {&touchable_, &passable_}) {
    const auto it = layer->tiles.find({column.x >> 3, column.y >> 3});
    if (it != layer->tiles.end()) put(*it->second, column, now.*layer->plane);
  }
  const auto forget = [&](Tiles& tiles, int margin) {
    const Cell low = tile_of({column.x * 8 - margin, column.y * 8 - margin});
    const Cell high = tile_of({column.x * 8 + 7 + margin, column.y * 8 + 7 + margin});
    for (std::int32_t y = low.y; y <= high.y; ++y) {
      for (std::int32_t x = low.x; x <= high.x; ++x) tiles.erase({x, y});
    }
  };
  forget(edges_, 1);
  forget(open_, reach_ + 1);
}

const FreeSpace::Rows& FreeSpace::rows(Layer& layer, Cell tile) {
  if (layer.last_rows != nullptr && tile == layer.last_tile) return *layer.last_rows;
  auto [it, is_new] = layer.tiles.try_emplace(tile);
  if (is_new) {
    auto rows = std::make_unique<Rows>();
    rows->fill(0);
    for (int by = 0; by < 8; ++by) {
      for (int bx = 0; bx < 8; ++bx) {
        const BrickIndex column{tile.x * 8 + bx, tile.y * 8 + by, 0};
        put(*rows, column, terrain_.at(column).*layer.plane);
      }
    }
    it->second = std::move(rows);
  }
  layer.last_tile = tile;
  layer.last_rows = it->second.get();
  return *layer.last_rows;
}

/// The cells that are not touchable but have such a neighbour, over a corner too: the nearest one to any touchable
/// point is one of them.
const FreeSpace::Rows& FreeSpace::edge_rows(Cell tile) {
  auto [it, is_new] = edges_.try_emplace(tile);
  if (!is_new) return *it->second;
  // Rows -1 to 64 of the tile, each spread by one cell to the left and right.
  std::array<std::uint64_t, kSide + 2> spread;
  for (int y = -1; y <= kSide; ++y) {
    const std::int32_t tile_y = tile.y + (y < 0 ? -1 : y / kSide);
    const std::uint64_t row = rows(touchable_, {tile.x, tile_y})[y & 63];
    const std::uint64_t left = rows(touchable_, {tile.x - 1, tile_y})[y & 63];
    const std::uint64_t right = rows(touchable_, {tile.x + 1, tile_y})[y & 63];
    spread[y + 1] = row | row << 1 | row >> 1 | left >> 63 | right << 63;
  }
  const Rows& touchable = rows(touchable_, tile);
  auto rows = std::make_unique<Rows>();
  for (int y = 0; y < kSide; ++y) (*rows)[y] = (spread[y] | spread[y + 1] | spread[y + 2]) & ~touchable[y];
  it->second = std::move(rows);
  return *it->second;
}

/// Closes what the blocked cells `edges` of the tile `dx`, `dy` tiles away close.
void FreeSpace::carve(Rows& open, const Rows& edges, int dx, int dy) const {
  for (int source = 0; source < kSide; ++source) {
    const int row = dy * kSide + source;
    if (row < -reach_ || row > kSide - 1 + reach_) continue;
    for (std::uint64_t bits = edges[source]; bits != 0;) {
      const int begin = std::countr_zero(bits);
      const int length = std::countr_one(bits >> begin);
      bits &= ~span_mask(begin, begin + length - 1);
      const int first = dx * kSide + begin;
      const int last = first + length - 1;
      for (int y = std::max(0, row - reach_); y <= std::min(kSide - 1, row + reach_); ++y) {
        const int width = widths_[std::abs(y - row)];
        open[y] &= ~span_mask(first - width, last + width);
      }
    }
  }
}

const FreeSpace::Rows& FreeSpace::open_rows(Cell tile) {
  auto [it, is_new] = open_.try_emplace(tile);
  if (!is_new) return *it->second;
  auto open = std::make_unique<Rows>(rows(terrain_.has_contact() ? passable_ : touchable_, tile));
  if (std::any_of(open->begin(), open->end(), [](std::uint64_t row) { return row != 0; })) {
    const int tiles = (reach_ + kSide - 1) / kSide;
    for (int dy = -tiles; dy <= tiles; ++dy) {
      for (int dx = -tiles; dx <= tiles; ++dx) carve(*open, edge_rows({tile.x + dx, tile.y + dy}), dx, dy);
    }
  }
  it->second = std::move(open);
  return *it->second;
}

bool FreeSpace::is_open(Cell cell) { return (open_rows(tile_of(cell))[cell.y & 63] >> (cell.x & 63) & 1) != 0; }

bool FreeSpace::has_row(Layer& layer, std::int32_t y, std::int32_t first, std::int32_t last) {
  for (std::int32_t tile_x = first >> 6; tile_x <= last >> 6; ++tile_x) {
    const std::uint64_t wanted = span_mask(first - tile_x * kSide, last - tile_x * kSide);
    if ((rows(layer, {tile_x, y >> 6})[y & 63] & wanted) != wanted) return false;
  }
  return true;
}

bool FreeSpace::sees(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  return covers(touchable_, from, to, radius_) && (!terrain_.has_contact() || covers(passable_, from, to, kTouch));
}

/// Whether all cells that a disc touches on its way are in the layer.
bool FreeSpace::covers(Layer& layer, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius) {
  const double low = std::min(from.y(), to.y());
  const double high = std::max(from.y(), to.y());
  const Eigen::Vector2d from_mirrored(-from.x(), from.y());
  const Eigen::Vector2d to_mirrored(-to.x(), to.y());
  // Cells are closed squares here: a row is concerned when the disc touches [y, y + 1].
  const auto first_row = static_cast<std::int32_t>(std::ceil(low - radius)) - 1;
  const auto last_row = static_cast<std::int32_t>(std::floor(high + radius));
  for (std::int32_t y = first_row; y <= last_row; ++y) {
    const double right = rightmost_in(from, to, radius, y);
    const double left = -rightmost_in(from_mirrored, to_mirrored, radius, y);
    if (left > right) continue;  // the strip is missed by a rounding error
    const auto first = static_cast<std::int32_t>(std::ceil(left)) - 1;
    const auto last = static_cast<std::int32_t>(std::floor(right));
    if (!has_row(layer, y, first, last)) return false;
  }
  return true;
}

}  // namespace concord
