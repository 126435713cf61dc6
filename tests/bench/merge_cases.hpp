#pragma once

#include <string>
#include <vector>

#include "core/brick_map.hpp"
#include "core/transform.hpp"

namespace concord::bench {

/// Two submaps to merge: A lies in the map as it is, B under `T_A_B`.
struct MergeCase {
  std::string name;
  double resolution = 0.0;
  BrickMap a;
  BrickMap b;
  Transform T_A_B = Transform::Identity();
  std::size_t layer_bytes = 0;  ///< heap that `a` and `b` take, as they were loaded or made
};

/// Heap in use, bytes.
[[nodiscard]] std::size_t heap_in_use();

/// A rotation about all axes and a translation off the lattice.
[[nodiscard]] Transform default_transform();

/// @param transform "x y z qx qy qz qw"; empty: the default. Throws std::runtime_error with what is wrong.
[[nodiscard]] Transform parse_transform(const std::string& transform);

/// `.bt` or `.ot`; B is brought to A's resolution. Throws std::runtime_error with what is wrong.
[[nodiscard]] MergeCase load_case(const std::string& a, const std::string& b, const Transform& T_A_B);

/// Two robots scan a warehouse with shelves from different places, densely as LiDARs do.
[[nodiscard]] MergeCase dense_case();
/// Two headsets see it with few rays: under 100 known voxels a brick.
[[nodiscard]] MergeCase sparse_case();

}  // namespace concord::bench
