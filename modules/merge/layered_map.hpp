#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/brick_map.hpp"
#include "core/brick_set.hpp"
#include "core/compose.hpp"
#include "core/lattice_transform.hpp"
#include "core/requests.hpp"
#include "merge/edit_layer.hpp"

namespace concord {

/// The map as a pure function of its layers, kept up to date at a cost that follows the change: whatever changes a
/// layer marks the map bricks that it touches (where it was and where it is), and `refold` composes just those afresh.
/// Its map equals, to the byte, what `compose` gives for the present layers, whatever the order of calls.
class LayeredMap {
 public:
  LayeredMap(double resolution, Policy policy) : resolution_(resolution), policy_(policy) {}

  /// The agent's layer begins anew, empty, in this frame and not aligned.
  void begin_layer(const std::string& agent, const std::string& frame_id, int weight);
  /// @pre begin_layer was called for the agent.
  void set_brick(const std::string& agent, BrickIndex index, Brick brick);
  /// Puts the layer into the map, or moves it. @pre begin_layer was called for the agent.
  void place(const std::string& agent, const Transform& T_map_agent);
  /// Whether all of the layer would lie within the map's bounds there.
  [[nodiscard]] bool fits(const std::string& agent, const Transform& T_map_agent) const;
  void remove_layer(const std::string& agent);

  /// @pre not applied yet, see EditLayer.
  void apply(const EditRequest& edit) { edits_.apply(edit, dirty_); }
  [[nodiscard]] const EditLayer& edits() const { return edits_; }

  /// What `refold` changed, ordered by tile and by position in the tile.
  struct Changes {
    std::vector<BrickIndex> map;
    std::vector<BrickIndex> conflicts;
  };
  Changes refold();

  /// As of the last refold.
  [[nodiscard]] const BrickMap& map() const { return merged_.values; }
  [[nodiscard]] const BrickMap& conflicts() const { return merged_.conflicts; }

  struct AgentLayer {
    std::string frame_id;
    BrickMap map;
    int weight = 1;
    std::optional<Transform> T_map_agent;
    std::optional<LatticeTransform> lattice;  ///< of T_map_agent
    std::int64_t known = 0;
    std::int64_t occupied = 0;
  };
  [[nodiscard]] const AgentLayer* find(const std::string& agent) const;
  [[nodiscard]] const std::map<std::string, AgentLayer>& layers() const { return layers_; }

 private:
  void mark(const AgentLayer& layer);
  void fold_into(const BrickSet& dirty, Changes& changes);

  double resolution_;
  Policy policy_;
  std::map<std::string, AgentLayer> layers_;
  EditLayer edits_;
  BrickSet dirty_;
  MergedMap merged_;
};

}  // namespace concord
