#pragma once

#include "bus/messages.hpp"

namespace concord {

/// From which revision of the map stream on it holds people's corrections.
struct MapEdits {
  std::int64_t utime = 0;
  std::int64_t boot_id = 0;        ///< of the map stream's sender
  std::int64_t edit_revision = 0;  ///< all corrections up to this one are in the map
  std::int64_t map_revision = 0;   ///< at the latest since this one
};

[[nodiscard]] Bytes encode(const MapEdits& value);
template <>
Decoded<MapEdits> decode(std::span<const std::uint8_t> bytes);

}  // namespace concord
