#include "view/block_store.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

namespace concord::hmd {
namespace {

constexpr ChunkBits kEmpty{};

/// An octant (8 x 8 x 8 cells) of a chunk is a brick's mask: its rows of 8 along x are bytes in both.
/// `mask` byte y + 8 z goes to chunk byte 2 (y' + 16 z') + x' / 8.
void put_octant(ChunkBits& chunk, int x, int y, int z, const std::array<std::uint8_t, 64>& rows) {
  for (int row = 0; row < 64; ++row) {
    const int cy = y * 8 + (row & 7), cz = z * 8 + (row >> 3);
    chunk[static_cast<std::size_t>(2 * (cy + 16 * cz) + x)] = rows[static_cast<std::size_t>(row)];
  }
}

std::array<std::uint8_t, 64> rows_of(const VoxelMask& mask) {
  std::array<std::uint8_t, 64> rows;
  for (std::size_t i = 0; i < 64; ++i) rows[i] = static_cast<std::uint8_t>(mask[i / 8] >> (8 * (i % 8)));
  return rows;
}

/// Pairs of neighbouring bits, joined: bit i of the answer is bit 2 i or bit 2 i + 1.
std::uint8_t halve(std::uint32_t bits) {
  bits |= bits >> 1;
  std::uint8_t out = 0;
  for (int i = 0; i < 8; ++i) out |= static_cast<std::uint8_t>((bits >> (2 * i) & 1) << i);
  return out;
}

/// A chunk at half its resolution: the octant of its parent.
std::array<std::uint8_t, 64> halved(const ChunkBits& chunk) {
  std::array<std::uint8_t, 64> rows{};
  const auto row = [&](int y, int z) {
    const auto at = static_cast<std::size_t>(2 * (y + 16 * z));
    return static_cast<std::uint32_t>(chunk[at] | chunk[at + 1] << 8);
  };
  for (int z = 0; z < 8; ++z) {
    for (int y = 0; y < 8; ++y) {
      const std::uint32_t four =
          row(2 * y, 2 * z) | row(2 * y + 1, 2 * z) | row(2 * y, 2 * z + 1) | row(2 * y + 1, 2 * z + 1);
      rows[static_cast<std::size_t>(y + 8 * z)] = halve(four);
    }
  }
  return rows;
}

}  // namespace

BlockStore::Place BlockStore::place_of(int level, const VoxelIndex& chunk) {
  return {{level, {chunk.x >> 2, chunk.y >> 2, chunk.z >> 2}}, (chunk.x & 3) | (chunk.y & 3) << 2 | (chunk.z & 3) << 4};
}

const ChunkBits* BlockStore::find(int level, const VoxelIndex& chunk) const {
  const auto [key, number] = place_of(level, chunk);
  const auto it = blocks_.find(key);
  const std::uint64_t bit = std::uint64_t{1} << number;
  if (it == blocks_.end() || (it->second.filled & bit) == 0) return nullptr;
  return &it->second.chunks[static_cast<std::size_t>(std::popcount(it->second.filled & (bit - 1)))];
}

bool BlockStore::replace(int level, const VoxelIndex& chunk, const ChunkBits& bits, std::int64_t revision) {
  const ChunkBits* held = find(level, chunk);
  const bool empty = bits == kEmpty;
  if (held == nullptr ? empty : *held == bits) return false;
  const auto [key, number] = place_of(level, chunk);
  Block& block = blocks_[key];
  const std::uint64_t bit = std::uint64_t{1} << number;
  const auto at = block.chunks.begin() + std::popcount(block.filled & (bit - 1));
  if (empty) {
    block.chunks.erase(at);
    block.filled &= ~bit;
  } else if (held == nullptr) {
    block.chunks.insert(at, bits);
    block.filled |= bit;
  } else {
    *at = bits;
  }
  block.changed[static_cast<std::size_t>(number)] = revision;
  block.revision = revision;
  block.whole = block.change = nullptr;
  return true;
}

void BlockStore::set(BrickIndex brick, const VoxelMask& occupied, std::int64_t revision,
                     std::vector<BlockKey>& changed) {
  const VoxelIndex chunk{brick.x >> 1, brick.y >> 1, brick.z >> 1};
  const ChunkBits* held = find(0, chunk);
  ChunkBits bits = held != nullptr ? *held : kEmpty;
  put_octant(bits, brick.x & 1, brick.y & 1, brick.z & 1, rows_of(occupied));
  if (!replace(0, chunk, bits, revision)) return;
  changed.push_back(place_of(0, chunk).block);
  raise(1, chunk, revision, changed);
}

void BlockStore::touch(BrickIndex brick, std::int64_t revision, std::vector<BlockKey>& changed) {
  const auto [key, number] = place_of(0, {brick.x >> 1, brick.y >> 1, brick.z >> 1});
  Block& block = blocks_[key];
  block.changed[static_cast<std::size_t>(number)] = revision;
  block.revision = revision;
  block.whole = block.change = nullptr;
  changed.push_back(key);
}

/// Carries a change of the chunk `chunk` of the level below upwards, as far as it shows.
void BlockStore::raise(int level, VoxelIndex chunk, std::int64_t revision, std::vector<BlockKey>& changed) {
  for (; level < levels_; ++level) {
    const VoxelIndex parent{chunk.x >> 1, chunk.y >> 1, chunk.z >> 1};
    const ChunkBits* below = find(level - 1, chunk);
    const ChunkBits* held = find(level, parent);
    ChunkBits bits = held != nullptr ? *held : kEmpty;
    put_octant(bits, chunk.x & 1, chunk.y & 1, chunk.z & 1, halved(below != nullptr ? *below : kEmpty));
    if (!replace(level, parent, bits, revision)) return;
    changed.push_back(place_of(level, parent).block);
    chunk = parent;
  }
}

void BlockStore::clear() { blocks_.clear(); }

std::int64_t BlockStore::revision(const BlockKey& key) const {
  const auto it = blocks_.find(key);
  return it != blocks_.end() ? it->second.revision : 0;
}

bool BlockStore::filled(const BlockKey& key) const {
  const auto it = blocks_.find(key);
  return it != blocks_.end() && it->second.filled != 0;
}

FramePointer BlockStore::said(const BlockKey& key, const Block& block) const {
  const Said what = say_(key.index);
  const FrameHead head{.kind = what.kind,
                       .whole = false,
                       .level = key.level,
                       .stream = stream_,
                       .count = what.count,
                       .revision = block.revision};
  return std::make_shared<const Bytes>(make_frame(head, what.payload));
}

void BlockStore::drop(const BlockKey& key) {
  dropped_ = std::max(dropped_, revision(key));
  blocks_.erase(key);
}

FramePointer BlockStore::frame(const BlockKey& key, std::int64_t since) {
  Block& block = blocks_.at(key);
  assert(block.revision > since);
  if (say_) {
    if (block.whole == nullptr) block.whole = said(key, block);
    return block.whole;
  }
  FramePointer& kept = since == 0 ? block.whole : block.change;
  if (kept != nullptr && (since == 0 || block.change_since == since)) return kept;

  BlockContent content;
  content.block = key.index;
  for (int i = 0; i < 64; ++i) {
    if (since == 0 || block.changed[static_cast<std::size_t>(i)] > since) content.told |= std::uint64_t{1} << i;
  }
  content.filled = block.filled & content.told;
  for (std::uint64_t bits = content.filled; bits != 0; bits &= bits - 1) {
    const std::uint64_t below = (bits & (~bits + 1)) - 1;
    content.chunks.push_back(block.chunks[static_cast<std::size_t>(std::popcount(block.filled & below))]);
  }
  const FrameHead head{.kind = FrameKind::kBlock,
                       .whole = since == 0,
                       .level = key.level,
                       .stream = stream_,
                       .count = static_cast<std::uint32_t>(content.chunks.size()),
                       .revision = block.revision};
  kept = std::make_shared<const Bytes>(make_frame(head, block_payload(content)));
  if (since != 0) block.change_since = since;
  return kept;
}

std::vector<BlockKey> BlockStore::emptied_before(std::int64_t revision) const {
  std::vector<BlockKey> keys;
  for (const auto& [key, block] : blocks_) {
    if (block.filled == 0 && block.revision < revision) keys.push_back(key);
  }
  return keys;
}

}  // namespace concord::hmd
