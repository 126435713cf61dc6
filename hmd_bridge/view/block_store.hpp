#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "core/brick.hpp"
#include "protocol/frame.hpp"

namespace concord::hmd {

/// A block of one level.
struct BlockKey {
  int level = 0;
  BlockIndex index;
  auto operator<=>(const BlockKey&) const = default;
};
struct BlockKeyHash {
  std::size_t operator()(const BlockKey& key) const {
    return IndexHash{}(key.index) + static_cast<std::size_t>(key.level) * 0x9E3779B97F4A7C15ULL;
  }
};

using FramePointer = std::shared_ptr<const Bytes>;

/// One layer (the map, conflicts, a grid, an agent's submap) as clients see it: which cells are occupied, at each level
/// of detail, and when each chunk changed last. Frames are made once for all clients that lack the same.
class BlockStore {
 public:
  /// What a block says instead of which cells are occupied: payload, and count of its head.
  struct Said {
    FrameKind kind;
    Bytes payload;
    std::uint32_t count;
  };
  using Say = std::function<Said(const BlockIndex&)>;

  /// @param levels 1 to kLevels. @param stream the number that its frames bear. @param say of each block of level 0,
  /// for a layer of that level alone whose cells are more than occupied; its frames are always whole.
  BlockStore(std::uint32_t stream, int levels, Say say = nullptr)
      : stream_(stream), levels_(levels), say_(std::move(say)) {}

  /// A brick is now this, as of `revision`. Appends the keys of the blocks that changed to `changed`, which may hold
  /// one twice. @pre `revision` is not below any earlier one, and at least 1.
  void set(BrickIndex brick, const VoxelMask& occupied, std::int64_t revision, std::vector<BlockKey>& changed);
  /// The same cells of a brick are occupied as before, but they say something else. @pre as for `set`.
  void touch(BrickIndex brick, std::int64_t revision, std::vector<BlockKey>& changed);
  /// Everything is gone, and forgotten.
  void clear();

  /// When a block changed last; 0 if it never was.
  [[nodiscard]] std::int64_t revision(const BlockKey& key) const;
  /// Whether any cell of it is occupied.
  [[nodiscard]] bool filled(const BlockKey& key) const;
  /// The frame that brings who has the block as of `since` to what it is now; whole if `since` is 0.
  /// @pre revision(key) > since.
  [[nodiscard]] FramePointer frame(const BlockKey& key, std::int64_t since);

  /// Blocks that are empty now and have been since before `revision`: forgotten if nobody needs to be told.
  [[nodiscard]] std::vector<BlockKey> emptied_before(std::int64_t revision) const;
  void drop(const BlockKey& key);
  /// Who has the layer as of an earlier revision than this may have blocks that were emptied and dropped since.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const auto& [key, block] : blocks_) visit(key, block.revision, block.filled != 0);
  }

  [[nodiscard]] std::uint32_t stream() const { return stream_; }
  [[nodiscard]] int levels() const { return levels_; }
  [[nodiscard]] std::size_t size() const { return blocks_.size(); }

 private:
  struct Block {
    std::int64_t revision = 0;
    std::uint64_t filled = 0;                ///< bit of each chunk with any cell
    std::array<std::int64_t, 64> changed{};  ///< by chunk
    std::vector<ChunkBits> chunks;           ///< packed, by bit of `filled`
    FramePointer whole, change;              ///< the latest made; null when out of date
    std::int64_t change_since = 0;
  };
  /// A chunk's place: its block and its number there.
  struct Place {
    BlockKey block;
    int number;
  };

  [[nodiscard]] static Place place_of(int level, const VoxelIndex& chunk);
  [[nodiscard]] const ChunkBits* find(int level, const VoxelIndex& chunk) const;
  bool replace(int level, const VoxelIndex& chunk, const ChunkBits& bits, std::int64_t revision);
  void raise(int level, VoxelIndex chunk, std::int64_t revision, std::vector<BlockKey>& changed);

  [[nodiscard]] FramePointer said(const BlockKey& key, const Block& block) const;

  std::uint32_t stream_;
  int levels_;
  Say say_;
  std::unordered_map<BlockKey, Block, BlockKeyHash> blocks_;
  std::int64_t dropped_ = 0;
};

}  // namespace concord::hmd
