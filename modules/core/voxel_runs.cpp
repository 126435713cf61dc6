#include "core/voxel_runs.hpp"

#include <algorithm>
#include <string>

namespace concord {

tl::unexpected<Error> refuse_too_many(std::int64_t most) {
  return refuse(Code::kTooLarge, "over " + std::to_string(most) + " voxels in one request; split it");
}

bool VoxelRuns::add(std::int32_t x, std::int32_t y, std::int32_t first, std::int32_t last) {
  part_ += std::int64_t{last} - first + 1;
  if (part_ > most_) return false;
  runs_.push_back({x, y, first, last});
  return true;
}

bool VoxelRuns::end_part() {
  part_ = 0;
  return static_cast<std::int64_t>(runs_.size()) <= 2 * most_ || join() <= most_;
}

/// Sorts and joins runs that overlap or follow each other. Returns the number of voxels.
std::int64_t VoxelRuns::join() {
  if (!std::ranges::is_sorted(runs_)) std::ranges::sort(runs_);
  std::size_t kept = 0;
  std::int64_t total = 0;
  for (const Run& run : runs_) {
    Run* last = kept > 0 ? &runs_[kept - 1] : nullptr;
    if (last != nullptr && last->x == run.x && last->y == run.y && run.first <= last->last + 1) {
      total += std::max(0, run.last - last->last);
      last->last = std::max(last->last, run.last);
    } else {
      total += run.last - run.first + 1;
      runs_[kept++] = run;
    }
  }
  runs_.resize(kept);
  return total;
}

Result<std::int64_t> VoxelRuns::count() {
  const std::int64_t total = join();
  if (total > most_) return refuse_too_many(most_);
  return total;
}

Result<std::vector<VoxelIndex>> VoxelRuns::take() {
  const auto total = count();
  if (!total) return tl::unexpected(total.error());
  std::vector<VoxelIndex> voxels;
  voxels.reserve(static_cast<std::size_t>(*total));
  for (const Run& run : runs_) {
    for (std::int32_t z = run.first; z <= run.last; ++z) voxels.push_back({run.x, run.y, z});
  }
  return voxels;
}

}  // namespace concord
