#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/brick_map.hpp"
#include "core/brick_set.hpp"
#include "core/compose.hpp"
#include "core/lattice_transform.hpp"

namespace concord {

/// The map as a pure function of its layers, kept up to date at a cost that follows the change: whatever changes a
/// layer marks the map bricks that it touches (where it was and where it is), and `refold` composes just those afresh.
/// Its map equals, to the byte, what `compose` gives for the present layers, whatever the order of calls.
class LayeredMap {
 public:
  /// `pins`, which must outlive this, may only change together with `mark`.
  LayeredMap(double resolution, Policy policy, const PinMap& pins)
      : resolution_(resolution), policy_(policy), pins_(pins) {}

  /// The agent's layer begins anew, empty, in this frame and not aligned.
  void begin_layer(const std::string& agent, const std::string& frame_id, int weight);
  /// @pre begin_layer was called for the agent.
  void set_brick(const std::string& agent, BrickIndex index, Brick brick);
  /// Puts the layer into the map, or moves it. @pre begin_layer was called for the agent.
  void place(const std::string& agent, const Transform& T_map_agent);
  /// Takes the layer out of the map; it waits to be placed. @pre begin_layer was called for the agent.
  void unplace(const std::string& agent);
  /// Whether all of the layer would lie within the map's bounds there.
  [[nodiscard]] bool fits(const std::string& agent, const Transform& T_map_agent) const;
  void remove_layer(const std::string& agent);
  /// @pre begin_layer was called for the agent.
  void set_weight(const std::string& agent, int weight);

  /// The pins of these bricks changed.
  void mark(const BrickSet& touched) { dirty_.insert(touched); }

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
  const PinMap& pins_;
  std::map<std::string, AgentLayer> layers_;
  BrickSet dirty_;
  MergedMap merged_;
};

}  // namespace concord
