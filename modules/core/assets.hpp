#pragma once

#include <cstdint>
#include <string>

#include "core/label_corrections.hpp"
#include "core/transform.hpp"

namespace concord {

inline constexpr std::size_t kMaxAssets = 1000;

/// A CAD model that the server keeps, to be put into the map.
struct Asset {
  std::string name;             ///< is_name; unique
  std::string class_name;       ///< is_title: what its voxels are labelled
  std::string file;             ///< its file's name in the asset folder
  double unit = 1.0;            ///< metres per unit of the file
  std::int64_t gltf_bytes = 0;  ///< of STATE/assets/gltf/NAME.glb, in metres, axes of the file; 0: none yet
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< along the file's axes, metres; 0: not known yet
  bool operator==(const Asset&) const = default;
};

/// Puts a model into the map, its voxels, surface and inside, pinned occupied and labelled, as one thing; moves that,
/// or takes it out again.
struct AssetRequest {
  enum class Op {
    kInject,
    kMove,    ///< what `of` put there lies at `T_map_asset` from now on
    kDelete,  ///< by an undo of the edit that put it where it lies; merge answers
  };
  std::string id;  ///< at most kMostAssetId bytes
  std::string author;
  Op op = Op::kInject;
  std::string asset;                              ///< its name; with kInject
  std::string of;                                 ///< the request that injected it; not with kInject
  InstanceId instance = {};                       ///< what is meant if `of` is empty; not with kInject
  Transform T_map_asset = Transform::Identity();  ///< of the file's own axes
  std::int64_t utime = 0;
};

/// The edit that an injection sends to merge is called so; who undoes it undoes the injection.
[[nodiscard]] inline std::string edit_of_asset(const std::string& request_id) { return "asset-" + request_id; }
inline constexpr std::size_t kMostAssetId = 40;

}  // namespace concord
