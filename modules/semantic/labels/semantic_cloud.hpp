#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/brick_map.hpp"
#include "core/byte_stream.hpp"
#include "core/error.hpp"
#include "core/label_corrections.hpp"

namespace concord {

/// One occupied voxel of the map: SLAM-XR's semantic point, with exact types.
struct SemanticPoint {
  float x = 0, y = 0, z = 0;  ///< its centre, metres, map frame
  float probability = 0;      ///< of being occupied
  std::uint32_t label = 0;    ///< class; 0: none
  std::uint32_t instance = 0;
  bool operator==(const SemanticPoint&) const = default;
};

/// The map with its labels as a cloud, and what the numbers of the classes mean.
struct SemanticCloud {
  double resolution = 0;
  std::map<ClassId, std::string> classes;  ///< those that have a point
  std::vector<SemanticPoint> points;       ///< by ascending voxel
  bool operator==(const SemanticCloud&) const = default;
};

inline constexpr std::size_t kMaxCloudPoints = 50'000'000;

/// The occupied voxels of a map, and the labels that they show (LabelView::shown). Refused (kNotFound): a label that no
/// slot says the meaning of.
[[nodiscard]] Result<SemanticCloud> semantic_cloud(const BrickMap& map, const BrickMap& labels,
                                                   const std::vector<LabelSlot>& slots, double resolution);

/// `.pcd` 0.7, DATA binary, little endian; fields x y z probability (F 4) label instance (U 4). Resolution and classes
/// stand in comments, which PCL passes over.
[[nodiscard]] Bytes write_pcd(const SemanticCloud& cloud);
/// `.ply`, binary little endian; the same, and red green blue (uchar): one colour for each class, a shade for each
/// instance, grey without a label.
[[nodiscard]] Bytes write_ply(const SemanticCloud& cloud);

/// What the writers wrote, whole. Refused: anything else (kMalformed), over kMaxCloudPoints (kTooLarge, before memory
/// is taken), a coordinate that is no number (kNotFinite), a class that is not named (kMalformed).
[[nodiscard]] Result<SemanticCloud> read_pcd(ByteSpan file);
[[nodiscard]] Result<SemanticCloud> read_ply(ByteSpan file);

/// The voxels of each instance, sorted. Refused (kOutOfBounds): points beyond any map.
[[nodiscard]] Result<std::map<InstanceId, std::vector<VoxelIndex>>> instances_of(const SemanticCloud& cloud);

}  // namespace concord
