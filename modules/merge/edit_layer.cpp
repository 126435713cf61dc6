#include "merge/edit_layer.hpp"

#include <cassert>

namespace concord {

void EditLayer::apply(const EditRequest& edit, BrickSet& touched) {
  assert(!revisions_.contains(edit.id));
  const PinMap::Pin pin = edit.op == EditRequest::Op::kAdd ? PinMap::Pin::kAdded : PinMap::Pin::kDeleted;
  for (const VoxelIndex voxel : edit.voxels) {
    pins_.set(voxel, pin);
    touched.insert(brick_of(voxel));
  }
  revisions_[edit.id] = ++revision_;
}

std::optional<std::int64_t> EditLayer::revision_of(const std::string& edit_id) const {
  const auto it = revisions_.find(edit_id);
  if (it == revisions_.end()) return std::nullopt;
  return it->second;
}

}  // namespace concord
