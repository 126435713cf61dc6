#pragma once

#include <vector>

#include "core/brick_map.hpp"

namespace concord {

/// One point per cell of edge `cell_size` that holds centres of occupied voxels: their centroid, metres, in the map's
/// frame; cells ascending by index (x, y, z). What pcl::VoxelGrid makes of those centres (SLAM-XR's downsampler), but
/// of any extent: PCL's cell numbers overflow 32 bits and it then answers the input. @pre both lengths are checked.
[[nodiscard]] std::vector<Eigen::Vector3f> downsample(const BrickMap& map, double resolution, double cell_size);

}  // namespace concord
