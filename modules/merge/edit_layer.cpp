#include "merge/edit_layer.hpp"

#include <cassert>

namespace concord {

void EditLayer::apply(const EditRequest& edit, BrickSet& touched) {
  assert(find(edit.id) == nullptr);
  const PinMap::Pin pin = edit.op == EditRequest::Op::kAdd ? PinMap::Pin::kAdded : PinMap::Pin::kDeleted;
  for (const VoxelIndex voxel : edit.voxels) {
    pins_.set(voxel, pin);
    touched.insert(brick_of(voxel));
  }
  applied_[edit.id] = {++revision_, content(edit)};
}

const EditLayer::Applied* EditLayer::find(const std::string& edit_id) const {
  const auto it = applied_.find(edit_id);
  return it != applied_.end() ? &it->second : nullptr;
}

std::uint64_t EditLayer::content(const EditRequest& edit) {
  std::uint64_t hash = static_cast<std::uint64_t>(edit.op);
  for (const VoxelIndex voxel : edit.voxels) hash = (hash ^ IndexHash{}(voxel)) * 0x9E3779B97F4A7C15ULL;
  return hash;
}

}  // namespace concord
