#include "core/brick_set.hpp"

#include <algorithm>

namespace concord {
namespace {

constexpr std::uint64_t range_mask(int low, int high, int stride, std::uint64_t unit) {
  std::uint64_t mask = 0;
  for (int i = low; i <= high; ++i) mask |= unit << (i * stride);
  return mask;
}

// [axis][low][high]: the bricks whose position on the axis is in the range.
constexpr auto kRanges = [] {
  std::array<std::array<std::array<std::uint64_t, kTileSide>, kTileSide>, 3> ranges{};
  for (int low = 0; low < kTileSide; ++low) {
    for (int high = low; high < kTileSide; ++high) {
      ranges[0][low][high] = range_mask(low, high, 1, 0x1111111111111111);
      ranges[1][low][high] = range_mask(low, high, 4, 0x000F000F000F000F);
      ranges[2][low][high] = range_mask(low, high, 16, 0x000000000000FFFF);
    }
  }
  return ranges;
}();

}  // namespace

std::uint64_t tile_box(const BrickIndex& low, const BrickIndex& high) {
  return kRanges[0][low.x][high.x] & kRanges[1][low.y][high.y] & kRanges[2][low.z][high.z];
}

void BrickSet::insert_box(BrickIndex low, BrickIndex high) {
  const TileIndex first = tile_of(low);
  const TileIndex last = tile_of(high);
  const auto from = [](std::int32_t bound, std::int32_t tile) { return std::max(bound - tile * kTileSide, 0); };
  const auto to = [](std::int32_t bound, std::int32_t tile) {
    return std::min(bound - tile * kTileSide, kTileSide - 1);
  };
  for (std::int32_t z = first.z; z <= last.z; ++z) {
    for (std::int32_t y = first.y; y <= last.y; ++y) {
      for (std::int32_t x = first.x; x <= last.x; ++x) {
        tiles_[{x, y, z}] |=
            tile_box({from(low.x, x), from(low.y, y), from(low.z, z)}, {to(high.x, x), to(high.y, y), to(high.z, z)});
      }
    }
  }
}

void BrickSet::insert(const BrickSet& other) {
  for (const auto& [tile, bricks] : other.tiles_) tiles_[tile] |= bricks;
}

bool BrickSet::contains(BrickIndex brick) const {
  const auto it = tiles_.find(tile_of(brick));
  return it != tiles_.end() && (it->second >> local_of(brick) & 1) != 0;
}

std::size_t BrickSet::size() const {
  std::size_t count = 0;
  for (const auto& [tile, bricks] : tiles_) count += std::popcount(bricks);
  return count;
}

std::vector<BrickSet::Entry> BrickSet::sorted() const {
  std::vector<Entry> entries;
  entries.reserve(tiles_.size());
  for (const auto& [tile, bricks] : tiles_) entries.push_back({tile, bricks});
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.tile < b.tile; });
  return entries;
}

}  // namespace concord
