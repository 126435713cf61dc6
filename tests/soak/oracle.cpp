#include "oracle.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace concord::soak {
namespace {

using Kind = Operation::Kind;

Operation operation(const auto& request, Kind kind, std::string subject) {
  Operation out;
  out.id = request.id;
  out.author = request.author;
  out.kind = kind;
  out.subject = std::move(subject);
  return out;
}

}  // namespace

Oracle::Oracle(double resolution, std::map<std::string, BrickMap> submaps) : resolution_(resolution) {
  for (auto& [agent, map] : submaps) submaps_[agent].map = std::move(map);
}

Operation Oracle::apply(const Request& request) {
  return std::visit([this](const auto& of) { return take(of); }, request);
}

Transform Oracle::T_map_of(const WorkFrame& frame) const {
  return frame.agent.empty() ? Transform::Identity() : submaps_.at(frame.agent).T_map_agent.value();
}

Oracle::Pins Oracle::pins_of(const EditRequest& request) const {
  const Transform T = T_map_of(request.frame);
  const auto voxels = select(request.shape, T, resolution_, kMaxEditVoxels);
  if (!voxels) throw std::runtime_error("merge took what selects nothing: " + voxels.error().message);
  Pins out;
  if (request.op != EditRequest::Op::kMove) {
    for (const VoxelIndex voxel : *voxels) out[voxel] = request.op == EditRequest::Op::kAdd;
    return out;
  }
  const BrickMap before = map().values;
  const Eigen::Vector3d by = (T.linear() * request.move / resolution_).array().round();
  std::vector<VoxelIndex> moved;
  for (const VoxelIndex voxel : *voxels) {
    if (is_occupied(before.at(voxel))) moved.push_back(voxel);
  }
  for (const VoxelIndex voxel : moved) out[voxel] = false;
  for (const VoxelIndex v : moved) {
    out[{v.x + static_cast<int>(by.x()), v.y + static_cast<int>(by.y()), v.z + static_cast<int>(by.z())}] = true;
  }
  return out;
}

Oracle::Pins Oracle::pins() const {
  Pins out;
  for (const auto& [id, pins] : edits_) {
    if (!is_active(id)) continue;
    for (const auto& [voxel, occupied] : pins) out[voxel] = occupied;
  }
  return out;
}

MergedMap Oracle::map() const {
  std::vector<Layer> layers;
  for (const auto& [agent, submap] : submaps_) {
    if (submap.T_map_agent) layers.push_back({&submap.map, *submap.T_map_agent, submap.weight});
  }
  PinMap pinned;
  for (const auto& [voxel, occupied] : pins())
    pinned.set(voxel, occupied ? PinMap::Pin::kAdded : PinMap::Pin::kDeleted);
  return compose(layers, pinned, Policy::kMean, resolution_);
}

Operation Oracle::take(const EditRequest& request) {
  const Pins pins = pins_of(request);
  const Kind kind = request.op == EditRequest::Op::kAdd      ? Kind::kAdd
                    : request.op == EditRequest::Op::kDelete ? Kind::kDelete
                                                             : Kind::kMove;
  Operation out = operation(request, kind, "");
  out.count = static_cast<std::int64_t>(pins.size());
  out.min = out.max = pins.begin()->first;
  for (const auto& [v, occupied] : pins) {
    out.min = {std::min(out.min.x, v.x), std::min(out.min.y, v.y), std::min(out.min.z, v.z)};
    out.max = {std::max(out.max.x, v.x), std::max(out.max.y, v.y), std::max(out.max.z, v.z)};
  }
  edits_.emplace_back(request.id, pins);
  return out;
}

Operation Oracle::take(const UndoRequest& request) {
  if (request.redo) {
    undone_.erase(request.edit_id);
  } else {
    undone_.insert(request.edit_id);
  }
  return operation(request, request.redo ? Kind::kRedo : Kind::kUndo, request.edit_id);
}

Operation Oracle::take(const ZoneRequest& request) {
  if (request.op == ZoneRequest::Op::kDelete) {
    zones_.erase(request.name);
    return operation(request, Kind::kZoneDelete, request.name);
  }
  Zone& zone = zones_[request.name];
  zone.name = request.name;
  zone.kind = request.kind;
  zone.volume = request.volume;
  zone.T_map_zone = T_map_of(request.frame);
  zone.author = request.author;
  return operation(request, request.op == ZoneRequest::Op::kAdd ? Kind::kZoneAdd : Kind::kZoneChange, request.name);
}

Operation Oracle::take(const WeightRequest& request) {
  submaps_.at(request.agent).weight = request.weight;
  return operation(request, Kind::kWeight, request.agent);
}

Operation Oracle::take(const TransformRequest& request) {
  submaps_.at(request.agent).T_map_agent = request.T_map_agent;
  return operation(request, Kind::kTransform, request.agent);
}

Operation Oracle::take(const LeaseRequest& request) {
  throw std::logic_error("lease " + request.id + " stands in the history");
}

}  // namespace concord::soak
