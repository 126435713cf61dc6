#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "core/corrections.hpp"
#include "core/error.hpp"
#include "merge/edit_layer.hpp"
#include "merge/region.hpp"

namespace concord {

/// From each hold: longer than a person's network hiccup, short enough that who vanished does not lock others out.
inline constexpr std::int64_t kLeaseTime = 10'000'000;

/// Of a lease along each of the map's axes, metres: who needs more holds several.
inline constexpr double kMaxLeaseSide = 20.0;
inline constexpr std::ptrdiff_t kMaxLeasesOfOne = 4;

/// Who works where. Not kept over a restart: a holder renews every few seconds, which takes the lease anew.
class Leases {
 public:
  explicit Leases(double resolution) : resolution_(resolution) {}

  /// What a hold leads to. Refused: an overlap with another author's lease, by bounding boxes, or an id that is another
  /// author's (kLocked); all kMaxLeases taken, or kMaxLeasesOfOne of the author (kBusy); over
  /// kMaxLeaseSide (kTooLarge). Those that are over at `now` do not count.
  [[nodiscard]] Result<Lease> check(const LeaseRequest& request, const Transform& T_map_frame, std::int64_t now) const;
  /// @pre check gave it.
  void hold(Lease lease);
  /// Refused: another author's (kLocked). Returns whether there was one: freed twice is free.
  [[nodiscard]] Result<bool> free(const LeaseRequest& request, std::int64_t now);
  /// Returns whether any was over.
  bool expire(std::int64_t now);

  /// Refused (kLocked): one of the voxels has its centre in another author's lease; or so many lie so near to some that
  /// telling is dear, on the safe side.
  [[nodiscard]] Result<void> check(const PinnedBricks& voxels, const std::string& author, std::int64_t now) const;
  /// Refused (kLocked): the bounding box overlaps that of another author's lease.
  [[nodiscard]] Result<void> check(const Eigen::AlignedBox3d& bounds, const std::string& author,
                                   std::int64_t now) const;

  /// In the order of their ids.
  [[nodiscard]] std::vector<Lease> list() const;

 private:
  struct Held {
    Lease lease;
    Eigen::AlignedBox3d bounds;  ///< in the map
    TurnedBox turned;
    [[nodiscard]] bool bars(const std::string& author, std::int64_t now) const {
      return lease.author != author && lease.until > now;
    }
  };
  [[nodiscard]] bool may_hold(const Held& held, BrickIndex index) const;
  [[nodiscard]] bool holds_any(const Held& held, BrickIndex index, const PinBrick& pins, std::int64_t& looks) const;

  double resolution_;
  std::map<std::string, Held> held_;
};

}  // namespace concord
