#include "planner/grid.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

namespace concord {
namespace {

/// 64 counters side by side: bit i of all of them is one word, so that adding a word of ones costs two operations.
class ColumnCounters {
 public:
  void add(std::uint64_t ones) {
    for (int i = 0; ones != 0; ++i) {
      assert(i < static_cast<int>(digits_.size()));
      const std::uint64_t carry = digits_[i] & ones;
      digits_[i] ^= ones;
      ones = carry;
    }
  }
  /// Which counters have reached `n`.
  [[nodiscard]] std::uint64_t at_least(std::int32_t n) const {
    std::uint64_t above = 0;
    std::uint64_t equal = ~std::uint64_t{0};
    for (int i = static_cast<int>(digits_.size()) - 1; i >= 0; --i) {
      const std::uint64_t digit = digits_[i];
      const bool wanted = (n >> i & 1) != 0;
      if (!wanted) above |= equal & digit;
      equal &= wanted ? digit : ~digit;
    }
    return above | equal;
  }

 private:
  std::array<std::uint64_t, 22> digits_{};  // the highest band has 2^21 voxels
};

/// The occupied ones among `known`; takes their values off the front of `value`.
std::uint64_t occupied_bits(std::uint64_t known, const LogOdds*& value) {
  std::uint64_t occupied = 0;
  for (std::uint64_t bits = known; bits != 0; bits &= bits - 1) {
    if (is_occupied(*value++)) occupied |= bits & (~bits + 1);
  }
  return occupied;
}

/// What stands in a column of cells, by whose word.
struct Standing {
  std::uint64_t observed = 0, pinned = 0;
};

/// The same, of a layer of a brick.
std::uint64_t add_occupied(std::uint64_t known, const LogOdds*& value, Standing& standing) {
  std::uint64_t occupied = 0;
  for (std::uint64_t bits = known; bits != 0; bits &= bits - 1) {
    const LogOdds odds = *value++;
    if (!is_occupied(odds)) continue;
    const std::uint64_t bit = bits & (~bits + 1);
    occupied |= bit;
    (odds == kPinnedOccupied ? standing.pinned : standing.observed) |= bit;
  }
  return occupied;
}

/// Adds layers [first, last) of a brick to the column below it.
void add_layers(const Brick& brick, int first, int last, Standing& standing, ColumnCounters& free) {
  const VoxelMask& known = brick.known();
  if (brick.is_uniform()) {
    const bool is_free_brick = is_free(brick.uniform_value());
    for (int layer = first; layer < last; ++layer) {
      if (is_free_brick) {
        free.add(known[layer]);
      } else {
        (brick.uniform_value() == kPinnedOccupied ? standing.pinned : standing.observed) |= known[layer];
      }
    }
    return;
  }
  const LogOdds* value = brick.packed().data();
  for (int layer = 0; layer < first; ++layer) value += std::popcount(known[layer]);
  for (int layer = first; layer < last; ++layer) {
    free.add(known[layer] & ~add_occupied(known[layer], value, standing));
  }
}

Brick to_brick(std::uint64_t occupied, std::uint64_t free) {
  const std::uint64_t known = occupied | free;
  if (occupied == 0 || free == 0) {
    return known == 0 ? Brick() : Brick::uniform({known}, occupied != 0 ? kOccupied : kFree);
  }
  std::array<LogOdds, 64> values;
  std::size_t count = 0;
  for (std::uint64_t bits = known; bits != 0; bits &= bits - 1) {
    values[count++] = (occupied & bits & (~bits + 1)) != 0 ? kOccupied : kFree;
  }
  return Brick::from_packed({known}, {values.data(), count});
}

}  // namespace

Result<Band> make_band(double zmin, double zmax, double resolution) {
  assert(resolution > 0);
  if (!std::isfinite(zmin) || !std::isfinite(zmax)) {
    return refuse(Code::kNotFinite, "a height of the band is not a number: give zmin and zmax in metres");
  }
  if (std::abs(zmin) >= kMaxVoxel * resolution || std::abs(zmax) >= kMaxVoxel * resolution) {
    return refuse(Code::kOutOfBounds, "the height band reaches beyond the map's bounds: give zmin and zmax in metres");
  }
  // The lowest voxel whose centre is not below `height`; floor() alone may be one off where a centre lies on it.
  const auto first_from = [resolution](double height) {
    auto z = static_cast<std::int32_t>(std::floor(height / resolution)) - 1;
    while ((z + 0.5) * resolution < height) ++z;
    return z;
  };
  const Band band{first_from(zmin), first_from(zmax), zmin, zmax};
  if (band.height() <= 0) {
    return refuse(Code::kEmpty, "the height band holds no voxel centre: zmax must be above zmin by a voxel or more");
  }
  return band;
}

Grid::Grid(double resolution, Band band, double free_share)
    : resolution_(resolution),
      band_(band),
      free_share_(free_share),
      needed_(std::max(1, static_cast<std::int32_t>(std::ceil(free_share * band.height() - 1e-9)))) {
  assert(resolution > 0 && band.height() > 0);
  assert(free_share > 0 && free_share <= 1);
}

std::vector<ColumnChange> Grid::update(const BrickMap& map, std::span<const BrickIndex> touched) {
  // Bit x + 4 y of a tile column: that column of bricks is to be projected.
  std::unordered_map<TileIndex, std::uint16_t, IndexHash> columns;
  for (const BrickIndex brick : touched) {
    if (brick.z < band_.first >> 3 || brick.z > (band_.last - 1) >> 3) continue;
    lowest_ = std::min(lowest_, brick.z);
    highest_ = std::max(highest_, brick.z);
    columns[{brick.x >> 2, brick.y >> 2, 0}] |= static_cast<std::uint16_t>(1U << ((brick.x & 3) | (brick.y & 3) << 2));
  }

  std::vector<ColumnChange> changes;
  std::vector<const Tile*> tiles;
  for (const auto& [tile_column, wanted] : columns) {
    tiles.clear();
    for (std::int32_t z = lowest_ >> 2; z <= highest_ >> 2; ++z) {
      tiles.push_back(map.find(TileIndex{tile_column.x, tile_column.y, z}));
    }
    for (unsigned bits = wanted; bits != 0; bits &= bits - 1) {
      const int column = std::countr_zero(bits);
      const BrickIndex index{tile_column.x * 4 + (column & 3), tile_column.y * 4 + (column >> 2), 0};
      ColumnChange change;
      if (replace(index, project(tiles, lowest_ >> 2, column), change)) changes.push_back(change);
    }
  }
  std::sort(changes.begin(), changes.end(),
            [](const ColumnChange& a, const ColumnChange& b) { return a.column < b.column; });
  return changes;
}

Grid::Planes Grid::project(std::span<const Tile* const> tiles, std::int32_t first_tile, int column) const {
  Standing standing;
  ColumnCounters free;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (tiles[i] == nullptr) continue;
    for (int level = 0; level < kTileSide; ++level) {
      const Brick* brick = tiles[i]->find(column | level << 4);
      if (brick == nullptr) continue;
      const std::int32_t bottom = ((first_tile + static_cast<std::int32_t>(i)) * kTileSide + level) * kBrickSide;
      const int first = std::clamp(band_.first - bottom, 0, kBrickSide);
      const int last = std::clamp(band_.last - bottom, 0, kBrickSide);
      if (first < last) add_layers(*brick, first, last, standing, free);
    }
  }
  const std::uint64_t occupied = standing.observed | standing.pinned;
  return {occupied, free.at_least(needed_) & ~occupied, standing.pinned & ~standing.observed};
}

void Grid::see(BrickIndex column, std::uint64_t known) {
  if (known == 0) return;
  std::uint64_t columns = known | known >> 32;
  columns |= columns >> 16;
  columns = (columns | columns >> 8) & 0xFF;
  const Cell corner{column.x * kBrickSide, column.y * kBrickSide};
  seen_.low = {std::min(seen_.low.x, corner.x + std::countr_zero(columns)),
               std::min(seen_.low.y, corner.y + std::countr_zero(known) / kBrickSide)};
  seen_.high = {std::max(seen_.high.x, corner.x + 63 - std::countl_zero(columns)),
                std::max(seen_.high.y, corner.y + (63 - std::countl_zero(known)) / kBrickSide)};
}

bool Grid::replace(BrickIndex column, const Planes& now, ColumnChange& change) {
  see(column, now.occupied | now.free);
  const bool pins_changed = now.pinned != pinned(column);
  if (now.pinned != 0) {
    pinned_[column] = now.pinned;
  } else if (pins_changed) {
    pinned_.erase(column);
  }
  const std::uint64_t was_free = free_plane(cells_.find(column));
  change = {column, was_free & ~now.free, now.free & ~was_free};
  return cells_.set(column, to_brick(now.occupied, now.free)) || pins_changed;
}

std::uint64_t free_plane(const Brick* brick) {
  if (brick == nullptr) return 0;
  const std::uint64_t known = brick->known()[0];
  if (brick->is_uniform()) return is_free(brick->uniform_value()) ? known : 0;
  const LogOdds* value = brick->packed().data();
  return known & ~occupied_bits(known, value);
}

}  // namespace concord
