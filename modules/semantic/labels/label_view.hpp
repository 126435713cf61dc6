#pragma once

#include <functional>
#include <map>
#include <vector>

#include "core/brick_map.hpp"
#include "semantic/labels/labels.hpp"

namespace concord {

/// Labels as they show in the map: a claimed voxel shows while it is occupied there. Kept brick by brick: `refresh` a
/// brick after its labels or its voxels changed.
class LabelView {
 public:
  /// Both must outlive this.
  LabelView(const Labels& labels, const BrickMap& map, double resolution)
      : labels_(labels), map_(map), resolution_(resolution) {}

  /// Returns whether what shows there changed.
  bool refresh(BrickIndex index);

  /// Each voxel that shows a label holds its instance's slot - 32767.
  [[nodiscard]] const BrickMap& shown() const { return shown_; }
  /// In the order of their numbers: every instance that has shown since the start.
  [[nodiscard]] std::vector<LabelSlot> slots() const;
  [[nodiscard]] std::size_t slot_count() const { return by_slot_.size(); }

  /// Its voxels, sorted. @param of instance 0: of all of its class.
  [[nodiscard]] std::vector<VoxelIndex> voxels_of(InstanceId of) const;
  /// What shows of each instance; of all (0), or of one class's.
  [[nodiscard]] std::map<InstanceId, std::vector<VoxelIndex>> by_instance(ClassId label) const;
  /// The same of a brick, by instance.
  [[nodiscard]] std::map<InstanceId, std::vector<VoxelIndex>> in_brick(BrickIndex index) const;
  /// Of all for which this holds.
  [[nodiscard]] std::map<InstanceId, std::vector<VoxelIndex>> by_instance(
      const std::function<bool(InstanceId)>& wanted) const;
  /// How it shows; without a voxel if it does not.
  [[nodiscard]] LabelInstance instance(InstanceId of) const;

  /// By ascending number; only what shows. Refused (kNotFound): a class that has not been named.
  [[nodiscard]] Result<std::vector<LabelInstance>> answer(const LabelQuery& query) const;

 private:
  [[nodiscard]] LabelInstance summary(InstanceId of, const std::vector<VoxelIndex>& voxels) const;
  [[nodiscard]] Result<std::vector<LabelInstance>> found(const LabelQuery& query) const;
  [[nodiscard]] std::vector<LabelInstance> within(const LabelQuery& query) const;
  [[nodiscard]] std::vector<VoxelIndex> border_of(const std::vector<VoxelIndex>& voxels) const;

  const Labels& labels_;
  const BrickMap& map_;
  double resolution_;
  BrickMap shown_;
  std::map<InstanceId, std::int32_t> slots_;
  std::vector<InstanceId> by_slot_;
};

}  // namespace concord
