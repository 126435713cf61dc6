#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "semantic/detections/object_fit.hpp"

namespace concord {

/// A model that is to lie in the map.
struct ModelToLay {
  std::filesystem::path file;
  double unit = 1.0;  ///< metres per unit of the file
  Transform T_map_asset = Transform::Identity();
  /// What it is fitted to, given the voxels where it lies now; none: it is to lie just there.
  std::function<BrickMasks(const BrickMasks& present)> surface = {};
  std::optional<Transform> T_map_present = {};  ///< where it lies now; nothing: nowhere yet
};

/// As it lies there.
struct LaidModel {
  ObjectFit fit;      ///< of one that was to be fitted; else just where it lies
  BrickMasks voxels;  ///< of its surface and inside
};

/// Reads, fits and voxelises. Takes as long as a hostile file can make it, and may crash: for a process of its own.
/// Refused: read_model, voxelize, surface_points; over kMaxLabelVoxels (kTooLarge).
[[nodiscard]] Result<LaidModel> lay_model(const ModelToLay& model, double resolution);

/// For the way back from that process. Refused: kMalformed.
[[nodiscard]] Bytes to_bytes(const LaidModel& laid);
[[nodiscard]] Result<LaidModel> laid_model_from_bytes(ByteSpan bytes);

}  // namespace concord
