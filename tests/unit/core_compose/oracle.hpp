#pragma once

#include <map>

#include "scene.hpp"

namespace concord::testing {

/// What a voxel of the map must be, and whether rounding may decide otherwise: a centre within 1e-4 of a boundary.
struct Expected {
  LogOdds value = kUnknown;
  bool conflict = false;
  bool may_differ = false;
};

/// The merged map by the rules alone: each voxel on its own, in double precision, without bricks.
[[nodiscard]] std::map<VoxelIndex, Expected> compose_by_rules(const Scene& scene, Policy policy);

}  // namespace concord::testing
