#pragma once

#include <utility>
#include <vector>

#include "mapper/room_mapper.hpp"

namespace concord::hmd {

/// What one look led to.
struct Judged {
  Result<void> taken;
  std::vector<std::pair<BrickIndex, Brick>> changed;  ///< ascending; empty bricks are gone
  std::int64_t occupied = 0;                          ///< voxels of the whole map
  std::size_t bytes = 0;                              ///< that the mapper takes
};

/// Takes in a mesh or voxels frame as it came. Refused: what read_mesh, read_voxels and RoomMapper::take refuse.
[[nodiscard]] Judged judge(RoomMapper& mapper, PackedFrame frame);

}  // namespace concord::hmd
