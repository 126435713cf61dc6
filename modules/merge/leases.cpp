#include "merge/leases.hpp"

#include <algorithm>
#include <bit>

#include "merge/region.hpp"

namespace concord {
namespace {

/// Voxels looked at for one request, over all leases: some tenths of a second. One lease over half of the largest edit
/// is well below.
constexpr std::int64_t kMostLooks = 1'000'000;

constexpr double kSlack = 1e-6;  ///< metres: corners that were turned are not exactly where they were

/// Who has it, what it is called, and how long they have to be waited for.
std::string words_for(const Lease& lease, std::int64_t now) {
  const std::int64_t seconds = std::max<std::int64_t>((lease.until - now + 999'999) / 1'000'000, 1);
  const std::string who = lease.author.empty() ? "somebody without a name" : lease.author;
  return who + " holds lease '" + lease.id + "' for " + std::to_string(seconds) + " s more, longer if it is renewed";
}

tl::unexpected<Error> locked_by(const Lease& lease, std::int64_t now) {
  return refuse(Code::kLocked, words_for(lease, now) + "; ask them, or again then");
}

}  // namespace

Result<Lease> Leases::check(const LeaseRequest& request, const Transform& T_map_frame, std::int64_t now) const {
  const auto same = held_.find(request.lease);
  if (same != held_.end() && same->second.bars(request.author, now)) {
    return refuse(Code::kLocked, words_for(same->second.lease, now) + "; choose another id");
  }
  const auto there = std::ranges::count_if(held_, [&](const auto& entry) { return entry.second.lease.until > now; });
  if (same == held_.end() && there >= static_cast<std::ptrdiff_t>(kMaxLeases)) {
    return refuse(Code::kBusy, "all " + std::to_string(kMaxLeases) + " leases are held; ask again in some seconds");
  }
  const auto own = std::ranges::count_if(held_, [&](const auto& entry) {
    return entry.first != request.lease && entry.second.lease.author == request.author &&
           entry.second.lease.until > now;
  });
  if (own >= kMaxLeasesOfOne) {
    return refuse(Code::kBusy, "one person may hold " + std::to_string(kMaxLeasesOfOne) + " leases; free one");
  }
  const Eigen::AlignedBox3d bounds = bounds_in_map(request.volume, T_map_frame);
  if (!(bounds.sizes().maxCoeff() <= kMaxLeaseSide + kSlack)) {
    return refuse(Code::kTooLarge, "a lease reaches at most 20 m along each axis of the map; hold several");
  }
  const auto free = check(bounds, request.author, now);
  if (!free) return tl::unexpected(free.error());
  return Lease{request.lease, request.author, request.volume, T_map_frame, now + kLeaseTime};
}

void Leases::hold(Lease lease) {
  const Eigen::AlignedBox3d bounds = bounds_in_map(lease.volume, lease.T_map_lease);
  const std::string id = lease.id;
  const TurnedBox turned = turned_bounds(lease.volume, lease.T_map_lease);
  held_[id] = {std::move(lease), bounds, turned};
}

Result<bool> Leases::free(const LeaseRequest& request, std::int64_t now) {
  const auto it = held_.find(request.lease);
  if (it == held_.end()) return false;
  if (it->second.bars(request.author, now)) return locked_by(it->second.lease, now);
  held_.erase(it);
  return true;
}

bool Leases::expire(std::int64_t now) {
  return std::erase_if(held_, [&](const auto& entry) { return entry.second.lease.until <= now; }) > 0;
}

Result<void> Leases::check(const PinnedBricks& voxels, const std::string& author, std::int64_t now) const {
  std::int64_t looks = kMostLooks;
  for (const auto& [id, held] : held_) {
    if (!held.bars(author, now)) continue;
    for (const auto& [index, pins] : voxels) {
      if (may_hold(held, index) && holds_any(held, index, pins, looks)) return locked_by(held.lease, now);
    }
  }
  return {};
}

/// False only if no voxel of the brick has its centre in the lease.
bool Leases::may_hold(const Held& held, BrickIndex index) const {
  const VoxelIndex first = origin_of(index);
  const double half = 0.5 * kBrickSide * resolution_;
  const Eigen::Vector3d centre =
      Eigen::Vector3d(first.x, first.y, first.z) * resolution_ + Eigen::Vector3d::Constant(half);
  if (held.bounds.squaredExteriorDistance(centre) > 3 * half * half) return false;
  return held.turned.box.squaredExteriorDistance(held.turned.T_box_map * centre) <= 3 * half * half;
}

bool Leases::holds_any(const Held& held, BrickIndex index, const PinBrick& pins, std::int64_t& looks) const {
  for (int word = 0; word < 8; ++word) {
    for (std::uint64_t bits = pins.occupied[word] | pins.free[word]; bits != 0; bits &= bits - 1) {
      if (--looks < 0) return true;
      const VoxelIndex voxel = voxel_at(index, word * 64 + std::countr_zero(bits));
      if (contains(held.lease.volume, held.lease.T_map_lease, centre_of(voxel, resolution_))) return true;
    }
  }
  return false;
}

Result<void> Leases::check(const Eigen::AlignedBox3d& bounds, const std::string& author, std::int64_t now) const {
  for (const auto& [id, held] : held_) {
    if (held.bars(author, now) && overlap(held.bounds, bounds)) return locked_by(held.lease, now);
  }
  return {};
}

std::vector<Lease> Leases::list() const {
  std::vector<Lease> leases;
  for (const auto& [id, held] : held_) leases.push_back(held.lease);
  return leases;
}

}  // namespace concord
