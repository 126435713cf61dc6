#pragma once

#include <vector>

#include "core/brick_map.hpp"
#include "core/transform.hpp"
#include "semantic/brick_masks.hpp"
#include "semantic/models/triangle_mesh.hpp"

namespace concord {

/// A place where a model seems to be.
struct FoundModel {
  Transform T_map_model = Transform::Identity();
  /// 0 to 1, a product: `matched` against kEnoughMatched of what was seen of it and against kEnoughShown of what one
  /// look shows of it at best; the square of the share that is not amidst free space, which counts kFreeWeight times;
  /// and the fourth power of `explained`. What is there besides, and what is seen not to be there, tells things apart
  /// better than what is not to be seen of them.
  double score = 0;
  double matched = 0;    ///< share of its surface in a voxel of furniture or at the face of one
  double free = 0;       ///< share of its surface that lies amidst what was seen to be free
  double seen = 0;       ///< share of its surface that is matched or near free space; 1 if the map has none
  double explained = 0;  ///< of the furniture within kBeyond of the box around it, but beside it, the share that is it
};

inline constexpr double kEnoughMatched = 0.8;
inline constexpr double kEnoughShown = 0.9;
inline constexpr double kFreeWeight = 3.0;
inline constexpr double kBeyond = 3.0;  ///< voxels
inline constexpr int kNearFree = 1;     ///< voxels along each axis

/// What a model takes up.
struct ModelBody {
  Eigen::AlignedBox3d box;  ///< metres, model's axes, with a margin of kBeyond voxels
  BrickMasks own;           ///< voxels of the model's own lattice that are in it or at the face of one that is
  BrickMasks beside;        ///< these and those at their faces: where noise puts what is of it
  double most_shown = 0;    ///< share of its surface that one look shows, from the side that shows most
};

/// `p_model`: points all over its surface, metres, its own axes. `R_upright_model`: as it stands in maps, whichever
/// way it is turned about z. Refused: as by voxelize.
[[nodiscard]] Result<ModelBody> model_body(const TriangleMesh& mesh, double scale,
                                           const std::vector<Eigen::Vector3d>& p_model,
                                           const Eigen::Matrix3d& R_upright_model, double resolution);

/// A map that is z up, as models are looked for in it.
struct SearchedMap {
  SearchedMap(const BrickMap& of, double metres);

  const BrickMap& map;
  double resolution;
  BrickMasks occupied;
  BrickMasks furniture;  ///< occupied, but not floor, ceiling or wall, nor in the two layers from the floor up, nor
                         ///< amidst others
  bool has_free = false;
};

/// What a map says of a model at a place; of its surface `p_model`, points all over it.
[[nodiscard]] FoundModel judged(const ModelBody& body, const std::vector<Eigen::Vector3d>& p_model,
                                const SearchedMap& searched, const Transform& T_map_model);

}  // namespace concord
