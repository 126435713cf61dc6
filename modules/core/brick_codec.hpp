#pragma once

#include "core/brick.hpp"
#include "core/byte_stream.hpp"
#include "core/error.hpp"

namespace concord {

/// The bytes of one brick, in network packets and in layer files. Equal bricks have equal bytes.
///
///     tag      one byte: form of the values (bits 0-2), form of the mask (bits 3-4), other bits 0
///     mask     which voxels are known:
///                all     nothing follows, all 512 are
///                sparse  8 bytes: which of the 64 mask bytes are not zero; then those
///                full    64 mask bytes; voxel v is bit v % 8 of byte v / 8
///     values   of the known voxels, in voxel order (int16, log-odds in 1/1024):
///                empty    nothing follows, no mask either: the brick is gone
///                uniform  one value
///                pair     the lower and the higher value, one bit a voxel (lowest bit first, padded with 0)
///                palette  number of values - 1 (one byte), the values ascending, as many bits a voxel as that needs
///                raw      one value a voxel
///
/// The shortest form is the only valid one; of equally short ones the one further down in these lists.
inline constexpr std::size_t kMaxBrickBytes = 1 + 64 + 2 * (kBrickVoxels - 1);

void append_brick(Bytes& out, const Brick& brick);

/// Takes one brick off the front of `in`, which stays as it was when the answer is a refusal.
/// Refused (kMalformed): anything that append_brick would not have written.
[[nodiscard]] Result<Brick> read_brick(ByteSpan& in);

}  // namespace concord
