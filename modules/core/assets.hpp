#pragma once

#include <cstdint>
#include <string>

#include "core/transform.hpp"

namespace concord {

inline constexpr std::size_t kMaxAssets = 1000;

/// A CAD model that the server keeps, to be put into the map.
struct Asset {
  std::string name;        ///< is_name; unique
  std::string class_name;  ///< is_title: what its voxels are labelled
  std::string file;        ///< its file's name in the asset folder
  double unit = 1.0;       ///< metres per unit of the file
  bool operator==(const Asset&) const = default;
};

/// Puts a model into the map: its voxels, surface and inside, pinned occupied and labelled, as one thing.
struct AssetRequest {
  std::string id;  ///< at most kMostAssetId bytes
  std::string author;
  std::string asset;
  Transform T_map_asset = Transform::Identity();  ///< of the file's own axes
  std::int64_t utime = 0;
};

/// The edit that an injection sends to merge is called so; who undoes it undoes the injection.
[[nodiscard]] inline std::string edit_of_asset(const std::string& request_id) { return "asset-" + request_id; }
inline constexpr std::size_t kMostAssetId = 70;

}  // namespace concord
