#pragma once

#include "core/brick_map.hpp"
#include "core/octomap_format.hpp"

namespace concord {

/// A map as the bytes of a `.bt` or `.ot` file that OctoMap reads: the same states at the same places, in `.ot` also
/// the same log-odds. Eight equal children are one leaf, as OctoMap prunes. An empty map is a file with size 0.
/// Refused (kOutOfBounds): voxels beyond OctoMap's 2^16 per axis; (kBadResolution) see checked_resolution.
[[nodiscard]] Result<Bytes> write_octomap_file(const BrickMap& map, double resolution, OctomapFormat format);

/// The same without a header: the payload of an octomap_msgs message. An empty map is no bytes at all.
[[nodiscard]] Result<Bytes> write_octomap_data(const BrickMap& map, OctomapFormat format);

}  // namespace concord
