#include "semantic/map_selection.hpp"

#include "core/label_corrections.hpp"
#include "semantic/segmentation/segment.hpp"

namespace concord {

void MapSelection::follow(const std::vector<AgentState>& agents) {
  agents_.clear();
  for (const AgentState& agent : agents) agents_[agent.id] = agent;
}

Result<Transform> MapSelection::T_map_frame(const WorkFrame& frame) const {
  if (frame.agent.empty()) return Transform::Identity();
  const auto it = agents_.find(frame.agent);
  if (it == agents_.end()) return refuse(Code::kNoAgent, "no agent " + frame.agent + " is known");
  const AgentState& agent = it->second;
  if (!frame.frame_id.empty() && frame.frame_id != agent.frame_id) {
    return refuse(Code::kBadFrame, "frame " + frame.frame_id + " of " + frame.agent + " is over");
  }
  if (!agent.aligned) return refuse(Code::kNotAligned, frame.agent + " is not aligned; align it first");
  return agent.T_map_agent;
}

Result<std::vector<VoxelIndex>> MapSelection::occupied(const Shape& shape, const WorkFrame& frame) const {
  const auto T = T_map_frame(frame);
  if (!T) return tl::unexpected(T.error());
  auto voxels = select(shape, *T, resolution_, kMaxLabelVoxels);
  if (voxels) std::erase_if(*voxels, [&](VoxelIndex v) { return !is_occupied(map_.at(v)); });
  return voxels;
}

Result<std::vector<VoxelIndex>> MapSelection::touched(const Shape& shape, const WorkFrame& frame) const {
  const auto T = T_map_frame(frame);
  if (!T) return tl::unexpected(T.error());
  const auto voxels = select(shape, *T, resolution_, kMaxLabelVoxels);
  if (!voxels) return voxels;
  if (voxels->empty()) return refuse(Code::kEmpty, "nothing was touched");
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const VoxelIndex v : *voxels) middle += centre_of(v, resolution_);
  middle /= static_cast<double>(voxels->size());
  const BrickMasks around = occupied_around(map_, reach_of_touch(middle, resolution_));
  return propose_object(around, resolution_, middle).map([](const Proposal& proposal) {
    return proposal.voxels.voxels();
  });
}

}  // namespace concord
