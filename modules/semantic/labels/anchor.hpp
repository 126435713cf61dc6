#pragma once

#include <utility>
#include <vector>

#include "core/agent_layer.hpp"
#include "core/label_corrections.hpp"
#include "semantic/brick_masks.hpp"

namespace concord {

/// Whose lattice a label is kept in: the agent that has the most of its voxels occupied where it lies now, if that is
/// at least half of them (of several, the first by id); else the map's. @param voxels of the map.
[[nodiscard]] LabelAnchor anchor_of(const std::vector<VoxelIndex>& voxels, const AgentLayers& layers,
                                    double resolution);

/// The voxels of the map that belong to a label now that its agent lies elsewhere.
///
/// Of the agent's lattice, the label has the voxels that hold the centre of a claimed one, and those whose centre lies
/// in a claimed one: all that the map's voxels were made from (the agent's map is not asked: it may have changed
/// since). The map's voxels now are those that the same rule makes from these. Where the agent lies as it did, it is
/// what was claimed, to the voxel.
/// Voxels beyond the map are left out. @pre both are rotations and translations within kFarthestPlacement.
[[nodiscard]] BrickMasks followed(const std::vector<std::pair<BrickIndex, VoxelMask>>& claimed,
                                  const Transform& T_map_agent_then, const Transform& T_map_agent_now,
                                  double resolution);

}  // namespace concord
