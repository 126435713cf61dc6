#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/brick_map.hpp"
#include "core/error.hpp"
#include "core/transform.hpp"

namespace concord {

/// One measurement of a range sensor or depth camera.
struct Scan {
  std::optional<Transform> T_agent_sensor;  ///< absent: points are occupied, nothing is freed
  double max_range = 0.0;                   ///< metres; a point beyond it frees the space up to it; 0: none
  std::vector<Eigen::Vector3f> points;      ///< agent's frame, metres
};

inline constexpr std::size_t kMaxScanPoints = 2'000'000;
/// A ray is cut off here, in edges of a voxel: 500 m at 5 cm. Its end then counts as beyond range.
inline constexpr double kMaxRayLength = 10'000;
/// Cells that all rays of one scan may cross, and bricks that they may touch (about 130 bytes each while it is taken).
inline constexpr std::uint64_t kMaxScanSteps = 500'000'000;
inline constexpr std::size_t kMaxScanBricks = 2'000'000;

/// What a scan adds to a voxel: log-odds +0.85 and -0.4, the sum clamped to [kFree, kOccupied] (OctoMap, Hornung 2013).
inline constexpr LogOdds kHit = 870;
inline constexpr LogOdds kMiss = -410;

struct CheckedScan {
  Scan scan;
  std::size_t skipped = 0;  ///< points that were left out: not finite (sensors say so of no return) or out of bounds
};

/// Makes a scan fit for `integrate` at this resolution. Refused: a sensor pose or max_range that is not finite, a
/// negative max_range (kNotFinite), a pose out of bounds (kOutOfBounds), more points than kMaxScanPoints, rays that
/// cross more than kMaxScanSteps cells (kTooLarge).
[[nodiscard]] Result<CheckedScan> checked(Scan scan, double resolution);

/// Adds a scan to a map and answers the bricks that changed, ascending. As OctoMap's insertPointCloud does: the cells
/// that a ray crosses before the one it ends in are free, that one is occupied; occupied wins within one scan; each
/// cell is updated once. Cells are found by exact traversal (Amanatides and Woo 1987).
/// Refused, and the map is as it was: more than kMaxScanBricks bricks touched. @pre `scan` came from `checked`.
[[nodiscard]] Result<std::vector<BrickIndex>> integrate(BrickMap& map, double resolution, const Scan& scan);

}  // namespace concord
