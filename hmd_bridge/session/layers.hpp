#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "view/block_store.hpp"

namespace concord::hmd {

inline constexpr std::uint32_t kMapStream = 0, kConflictStream = 1, kGridOccupiedStream = 2, kGridFreeStream = 3,
                               kLabelStream = 4, kFirstAgentStream = 16;

/// One layer that clients look at, and the revisions it is told with.
struct ShownLayer {
  ShownLayer(std::uint32_t stream, int levels, BlockStore::Say say) : store(stream, levels, std::move(say)) {}
  BlockStore store;
  std::string epoch;
  std::int64_t revision = 0;      ///< of the bridge: when anything in it changed last
  std::int64_t map_revision = 0;  ///< of the stream on the bus
  bool synced = false;
  std::vector<BlockKey> changed;  ///< since clients were told
};

/// All layers, and the one counter that their revisions are taken from.
class Layers {
 public:
  ShownLayer& open(std::uint32_t stream, int levels, BlockStore::Say say = nullptr) {
    return layers_.try_emplace(stream, stream, levels, std::move(say)).first->second;
  }
  void close(std::uint32_t stream) { layers_.erase(stream); }
  [[nodiscard]] ShownLayer* find(std::uint32_t stream) {
    const auto it = layers_.find(stream);
    return it != layers_.end() ? &it->second : nullptr;
  }
  [[nodiscard]] std::map<std::uint32_t, ShownLayer>& all() { return layers_; }

  /// Each change has a revision of its own: a frame that is made between two of them lacks the second, and it shows.
  void set(ShownLayer& layer, BrickIndex brick, const VoxelMask& occupied) {
    const std::size_t before = layer.changed.size();
    layer.store.set(brick, occupied, revision_ + 1, layer.changed);
    if (layer.changed.size() != before) layer.revision = ++revision_;
  }
  /// The same for cells that are occupied as before and say something else.
  void touch(ShownLayer& layer, BrickIndex brick) {
    layer.store.touch(brick, ++revision_, layer.changed);
    layer.revision = revision_;
  }
  [[nodiscard]] std::int64_t revision() const { return revision_; }

 private:
  std::map<std::uint32_t, ShownLayer> layers_;
  std::int64_t revision_ = 0;
};

}  // namespace concord::hmd
