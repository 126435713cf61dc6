#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "core/brick_map.hpp"
#include "core/error.hpp"

namespace concord {

/// Grids as ROS's map_server writes them: a .yaml and the .pgm beside it that it names.
struct MapServerInfo {
  std::string image;  ///< a file's name, without a folder
  double resolution = 0.05;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< lower left corner, map frame, metres
  bool negate = false;
  double occupied_thresh = 0.65, free_thresh = 0.25;
};

/// Refused: what is no such file, a mode other than trinary, an origin that is turned, an image in another folder
/// (kMalformed), numbers that are none (kNotFinite), a resolution not within 1 mm to 10 m (kBadResolution).
[[nodiscard]] Result<MapServerInfo> read_map_server_yaml(std::string_view text);

/// The cells of a binary .pgm as voxels with z = 0, kOccupied or kFree; cell (0, 0) is the lower left one.
/// Refused: another format or too few bytes (kMalformed), over kMaxPgmCells (kTooLarge).
[[nodiscard]] Result<BrickMap> read_map_server_pgm(const MapServerInfo& info, std::span<const std::uint8_t> bytes);
inline constexpr std::int64_t kMaxPgmCells = 100'000'000;

}  // namespace concord
