#pragma once

#include <optional>

#include "core/brick_map.hpp"
#include "core/octomap_format.hpp"

namespace concord {

/// What a tree may grow to; checked against the bytes before any memory is taken for voxels.
struct OctomapLimits {
  std::size_t bytes = 200'000'000;
  std::uint64_t known_voxels = 400'000'000;
  std::uint64_t bricks = 4'000'000;
};

struct OctomapImport {
  BrickMap map;
  double resolution = 0.0;  ///< of `map`, metres
};

/// Reads a `.bt` or `.ot` file of an OcTree, as `target_resolution` if one is given.
///
/// States are exact. Leaves of a binary tree become kFree and kOccupied, those of a full one to_log_odds of theirs.
/// A pruned leaf covers its whole cube. The same resolution needs no arithmetic; any other goes through `resample`.
///
/// Stricter than OctoMap's own reader. Refused: truncated or trailing bytes, another number of nodes than the header
/// says (OctoMap refuses that in .bt as well, and ignores it in .ot), inner nodes without children, a tree deeper than
/// 16 levels (all kMalformed), values that are no number (kNotFinite), more than `limits` allow (kTooLarge), other
/// tree types, files from before the text header.
[[nodiscard]] Result<OctomapImport> read_octomap_file(ByteSpan bytes, std::optional<double> target_resolution,
                                                      const OctomapLimits& limits = {});

/// Reads the payload of an octomap_msgs message: the tree alone. No bytes at all are an empty map.
[[nodiscard]] Result<OctomapImport> read_octomap_data(ByteSpan bytes, OctomapFormat format, double resolution,
                                                      std::optional<double> target_resolution,
                                                      const OctomapLimits& limits = {});

}  // namespace concord
