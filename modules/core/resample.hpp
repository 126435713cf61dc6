#pragma once

#include <cstdint>
#include <stop_token>

#include "core/brick_map.hpp"
#include "core/error.hpp"

namespace concord {

/// Two resolutions that differ by less than this share are one: OctoMap writes six digits.
inline constexpr double kSameResolution = 1e-5;

[[nodiscard]] bool same_resolution(double a, double b);

/// A map of resolution `source` on the lattice of resolution `target` (same origin and axes).
/// To a coarser one: a voxel has the largest value among the known source voxels whose centres it holds.
/// To a finer one: a voxel has the value of the source voxel that holds its centre.
/// Refused: more than `max_bricks` bricks (kTooLarge, before they are made), indices out of bounds (kOutOfBounds).
/// Once a stop is asked for it ends before the next brick, and what it returns is of no use.
[[nodiscard]] Result<BrickMap> resample(const BrickMap& map, double source, double target, std::uint64_t max_bricks,
                                        const std::stop_token& stop = {});

}  // namespace concord
