#pragma once

#include <string>

#include "core/error.hpp"
#include "core/shape.hpp"

namespace concord {

/// Reads three whole numbers a line: voxels of the map's lattice, of edge `resolution`. Taken whole or not at all.
/// Refused: kNotFound, kIo, a line that holds anything else (kMalformed), over kMaxEditVoxels or scattered over more
/// boxes than a request holds (kTooLarge), beyond any map (kOutOfBounds), none (kEmpty).
[[nodiscard]] Result<VoxelList> read_voxels(const std::string& file, double resolution);

}  // namespace concord
