#include "core/brick_map.hpp"

#include <algorithm>
#include <cassert>

#include <xxhash.h>

namespace concord {
namespace {

constexpr std::size_t kTileGrowth = 8;  // bricks

std::size_t known_voxels(const Tile& tile) {
  std::size_t count = 0;
  for (const Brick& brick : tile.bricks) count += brick.known_count();
  return count;
}

}  // namespace

const Tile* BrickMap::find(TileIndex index) const {
  const auto it = tiles_.find(index);
  return it != tiles_.end() ? &it->second : nullptr;
}

const Brick* BrickMap::find(BrickIndex index) const {
  const Tile* tile = find(tile_of(index));
  return tile != nullptr ? tile->find(local_of(index)) : nullptr;
}

LogOdds BrickMap::at(VoxelIndex voxel) const {
  const Brick* brick = find(brick_of(voxel));
  return brick != nullptr ? brick->at(local_of(voxel)) : kUnknown;
}

bool BrickMap::set(BrickIndex index, Brick brick) {
  const TileIndex tile_index = tile_of(index);
  const std::uint64_t bit = std::uint64_t{1} << local_of(index);
  auto it = tiles_.find(tile_index);
  if (it == tiles_.end()) {
    if (brick.empty()) return false;
    it = tiles_.try_emplace(tile_index).first;
  }
  Tile& tile = it->second;
  const auto position = tile.bricks.begin() + std::popcount(tile.present & (bit - 1));
  if ((tile.present & bit) != 0) {
    if (*position == brick) return false;
    known_count_ += brick.known_count() - position->known_count();
    if (!brick.empty()) {
      *position = std::move(brick);
      return true;
    }
    tile.bricks.erase(position);
    tile.present &= ~bit;
    --brick_count_;
    if (tile.present == 0) tiles_.erase(it);
    return true;
  }
  if (brick.empty()) return false;
  known_count_ += brick.known_count();
  // Grown by a few at a time: doubling would waste as much as many bricks take.
  const std::ptrdiff_t offset = position - tile.bricks.begin();
  if (tile.bricks.size() == tile.bricks.capacity()) tile.bricks.reserve(tile.bricks.size() + kTileGrowth);
  tile.bricks.insert(tile.bricks.begin() + offset, std::move(brick));
  tile.present |= bit;
  ++brick_count_;
  return true;
}

void BrickMap::set(TileIndex index, Tile tile) {
  assert(static_cast<std::size_t>(std::popcount(tile.present)) == tile.bricks.size());
  const auto it = tiles_.find(index);
  if (it != tiles_.end()) {
    brick_count_ -= it->second.bricks.size();
    known_count_ -= known_voxels(it->second);
  }
  brick_count_ += tile.bricks.size();
  known_count_ += known_voxels(tile);
  if (tile.present != 0) {
    tiles_.insert_or_assign(index, std::move(tile));
  } else if (it != tiles_.end()) {
    tiles_.erase(it);
  }
}

void BrickMap::clear() {
  tiles_.clear();
  brick_count_ = 0;
  known_count_ = 0;
}

std::size_t BrickMap::occupied_count() const {
  std::size_t count = 0;
  for_each_brick([&](BrickIndex, const Brick& brick) { count += brick.occupied_count(); });
  return count;
}

std::vector<TileIndex> BrickMap::sorted_tiles() const {
  std::vector<TileIndex> indices;
  indices.reserve(tiles_.size());
  for (const auto& [index, tile] : tiles_) indices.push_back(index);
  std::sort(indices.begin(), indices.end());
  return indices;
}

std::vector<BrickIndex> BrickMap::sorted_bricks() const {
  std::vector<BrickIndex> indices;
  indices.reserve(brick_count_);
  for_each_brick([&](BrickIndex index, const Brick&) { indices.push_back(index); });
  std::sort(indices.begin(), indices.end());
  return indices;
}

bool BrickMap::operator==(const BrickMap& other) const {
  if (brick_count_ != other.brick_count_) return false;
  for (const auto& [index, tile] : tiles_) {
    const Tile* theirs = other.find(index);
    if (theirs == nullptr || theirs->present != tile.present || theirs->bricks != tile.bricks) return false;
  }
  return true;
}

std::uint64_t content_hash(BrickIndex index, const Brick& brick) {
  // Hashed as explicit little-endian bytes so that the digest does not depend on the machine.
  std::array<unsigned char, 12 + 64 + 2 * kBrickVoxels> bytes;
  std::size_t size = 0;
  const auto put = [&](std::uint64_t value, int width) {
    for (int i = 0; i < width; ++i) bytes[size++] = static_cast<unsigned char>(value >> (8 * i));
  };
  put(static_cast<std::uint32_t>(index.x), 4);
  put(static_cast<std::uint32_t>(index.y), 4);
  put(static_cast<std::uint32_t>(index.z), 4);
  for (const std::uint64_t word : brick.known()) put(word, 8);
  if (brick.is_uniform()) {
    put(static_cast<std::uint16_t>(brick.uniform_value()), 2);
  } else {
    for (const LogOdds l : brick.packed()) put(static_cast<std::uint16_t>(l), 2);
  }
  return XXH3_64bits(bytes.data(), size);
}

std::uint64_t digest(const BrickMap& map) {
  std::uint64_t sum = 0;  // a sum does not depend on the order of its terms
  map.for_each_brick([&](BrickIndex index, const Brick& brick) { sum += content_hash(index, brick); });
  return sum;
}

}  // namespace concord
