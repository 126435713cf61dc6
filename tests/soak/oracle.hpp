#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/compose.hpp"
#include "core/corrections.hpp"
#include "request.hpp"

namespace concord::soak {

/// What people's requests lead to, found plainly: voxel by voxel, request by request in the order of their revisions,
/// and every map composed from nothing. Shares with merge what core promises (select, compose), none of its own code.
class Oracle {
 public:
  Oracle(double resolution, std::map<std::string, BrickMap> submaps);

  /// Applies a request that was taken. Returns what the history must say of it (its revision and time left out).
  Operation apply(const Request& request);

  [[nodiscard]] MergedMap map() const;
  [[nodiscard]] const std::map<std::string, Zone>& zones() const { return zones_; }
  /// Of an edit, as it is now: not undone.
  [[nodiscard]] bool is_active(const std::string& edit_id) const { return !undone_.contains(edit_id); }

 private:
  using Pins = std::map<VoxelIndex, bool>;  ///< true: occupied

  struct Submap {
    BrickMap map;
    int weight = 1;
    std::optional<Transform> T_map_agent;
  };

  [[nodiscard]] Transform T_map_of(const WorkFrame& frame) const;
  [[nodiscard]] Pins pins_of(const EditRequest& request) const;
  [[nodiscard]] Pins pins() const;

  Operation take(const EditRequest& request);
  Operation take(const UndoRequest& request);
  Operation take(const ZoneRequest& request);
  Operation take(const WeightRequest& request);
  Operation take(const TransformRequest& request);
  Operation take(const LeaseRequest& request);

  double resolution_;
  std::map<std::string, Submap> submaps_;
  std::vector<std::pair<std::string, Pins>> edits_;  ///< by id, in the order in which they were made
  std::set<std::string> undone_;
  std::map<std::string, Zone> zones_;
};

}  // namespace concord::soak
