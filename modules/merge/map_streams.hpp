#pragma once

#include "bus/brick_stream.hpp"
#include "bus/process.hpp"
#include "merge/layered_map.hpp"

namespace concord {

/// The map and its conflicts, and the streams that say what they are.
class MapStreams {
 public:
  /// `pins` must outlive this.
  MapStreams(const NodeContext& context, const PinMap& pins);

  [[nodiscard]] LayeredMap& layers() { return layers_; }
  [[nodiscard]] const LayeredMap& layers() const { return layers_; }

  /// Folds what changed, and says it if the streams have begun.
  void refold_and_send();
  /// From now on the streams say what the map is. @pre not begun.
  void begin();
  [[nodiscard]] bool begun() const { return begun_; }

  [[nodiscard]] std::int64_t boot_id() const { return map_stream_.boot_id(); }
  [[nodiscard]] std::int64_t revision() const { return map_stream_.revision(); }
  [[nodiscard]] std::int64_t bytes_sent() const { return map_stream_.bytes_sent() + conflict_stream_.bytes_sent(); }

 private:
  LayeredMap layers_;
  BrickSender map_stream_;
  BrickSender conflict_stream_;
  bool begun_ = false;
};

}  // namespace concord
