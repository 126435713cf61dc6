#pragma once

#include <bit>
#include <cmath>
#include <optional>

#include "core/brick.hpp"
#include "core/octomap_format.hpp"

namespace concord {

/// A leaf of an octree: all voxels of a cube of 2^level voxels a side.
struct OctreeLeaf {
  VoxelIndex origin;  ///< its lowest corner
  int level = 0;
  LogOdds value = kUnknown;
};

/// Walks the bytes of an OctoMap tree depth first, children x fastest, so that all leaves of a brick come together.
/// `visit(const OctreeLeaf&)` says whether to go on. Recursion ends at 16 levels.
template <class Visit>
class OctreeWalk {
 public:
  OctreeWalk(ByteSpan bytes, OctomapFormat format, Visit visit) : in_(bytes), format_(format), visit_(visit) {}

  /// The number of nodes, or why the bytes are no tree. Stopped by `visit`: the nodes so far.
  [[nodiscard]] Result<std::uint64_t> run() {
    const VoxelIndex origin{kOctomapOrigin, kOctomapOrigin, kOctomapOrigin};
    const bool done =
        format_ == OctomapFormat::kBinary ? binary_node(origin, kOctomapDepth) : full_node(origin, kOctomapDepth);
    if (error_) return tl::unexpected(*error_);
    if (done && !in_.empty()) return refuse(Code::kMalformed, "OctoMap tree is followed by bytes that are not of it");
    return nodes_;
  }

 private:
  static VoxelIndex child_origin(VoxelIndex origin, int level, int child) {
    const std::int32_t side = 1 << (level - 1);
    return {origin.x + (child & 1) * side, origin.y + (child >> 1 & 1) * side, origin.z + (child >> 2) * side};
  }

  bool fail(Code code, const char* message) {
    error_ = Error{code, message};
    return false;
  }

  /// An inner node: for each child two bits, 0 unknown, 1 free, 2 occupied, 3 an inner node.
  bool binary_node(VoxelIndex origin, int level) {
    ++nodes_;
    const std::optional<std::uint16_t> children = read_le<std::uint16_t>(in_);
    if (!children) return fail(Code::kMalformed, "OctoMap tree ends early; was it cut off?");
    if (*children == 0) return fail(Code::kMalformed, "OctoMap tree has an inner node without children");
    const std::uint16_t inner = *children & (*children >> 1) & 0x5555;
    if (inner != 0 && level == 1) return fail(Code::kMalformed, "OctoMap tree is deeper than 16 levels");
    for (int child = 0; child < 8; ++child) {
      const int code = *children >> (2 * child) & 3;
      if (code == 0) continue;
      const VoxelIndex child_at = child_origin(origin, level, child);
      if (code == 3) {
        if (!binary_node(child_at, level - 1)) return false;
      } else {
        ++nodes_;
        if (!visit_(OctreeLeaf{child_at, level - 1, code == 1 ? kFree : kOccupied})) return false;
      }
    }
    return true;
  }

  /// A node: its log-odds as a float and a bit for each child; a leaf has none.
  bool full_node(VoxelIndex origin, int level) {
    ++nodes_;
    const std::optional<std::uint32_t> bits = read_le<std::uint32_t>(in_);
    const std::optional<std::uint8_t> children = read_le<std::uint8_t>(in_);
    if (!bits || !children) return fail(Code::kMalformed, "OctoMap tree ends early; was it cut off?");
    const float value = std::bit_cast<float>(*bits);
    if (!std::isfinite(value)) return fail(Code::kNotFinite, "OctoMap tree has log-odds that are not finite");
    if (*children == 0) return visit_(OctreeLeaf{origin, level, to_log_odds(value)});
    if (level == 0) return fail(Code::kMalformed, "OctoMap tree is deeper than 16 levels");
    for (int child = 0; child < 8; ++child) {
      if ((*children >> child & 1) != 0 && !full_node(child_origin(origin, level, child), level - 1)) return false;
    }
    return true;
  }

  ByteSpan in_;
  OctomapFormat format_;
  Visit visit_;
  std::uint64_t nodes_ = 0;
  std::optional<Error> error_;
};

}  // namespace concord
