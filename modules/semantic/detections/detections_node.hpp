#pragma once

#include <map>
#include <string>

#include "bus/layers_node.hpp"
#include "bus/messages_detection.hpp"
#include "bus/process.hpp"
#include "bus/recent_answers.hpp"
#include "bus/replies.hpp"
#include "semantic/assets/assets_node.hpp"
#include "semantic/detections/sightings.hpp"
#include "semantic/map_selection.hpp"
#include "semantic/semantic_store.hpp"

namespace concord {

/// What is seen of known objects: refused, proposed to people, or one that is known already. What a person confirms is
/// fitted to the map and injected; what was injected, be it so or by hand, is moved when it is seen elsewhere.
/// Proposals are kept in memory only: who sees says so again. No number is given twice.
class DetectionsNode {
 public:
  struct Parts {
    const BrickMap& map;
    const Labels& labels;
    LayersNode& layers;
    AssetsNode& assets;
    SemanticStore& store;
    const MapSelection& selection;
  };
  DetectionsNode(const NodeContext& context, Parts parts);
  DetectionsNode(const DetectionsNode&) = delete;
  DetectionsNode& operator=(const DetectionsNode&) = delete;

 private:
  void on_detection(const Detection& detection);
  void on_decision(const DetectionDecision& decision);
  [[nodiscard]] Result<std::int64_t> next_number();
  [[nodiscard]] Result<Sightings::Seen> see(const Detection& detection);
  [[nodiscard]] Result<const Asset*> asset_called(const std::string& name) const;
  [[nodiscard]] Result<const Thing*> open_thing(const DetectionDecision& decision) const;
  void confirm(const DetectionDecision& decision, std::uint64_t content, const Thing& thing);
  void move(const Thing& thing, const Transform& T_map_asset);
  [[nodiscard]] BrickMasks surface_without(const BrickMasks& present);
  [[nodiscard]] bool is_seen(VoxelIndex voxel) const;
  void follow_injections();

  NodeContext context_;
  Parts parts_;
  Replies replies_;
  RecentAnswers answers_;
  std::int64_t number_ = 0, last_number_ = -1;  ///< the next that a thing is given, and how far it may go
  Sightings sightings_;
  ListSender<Thing> list_;
  std::map<std::string, std::int64_t> confirmed_;  ///< injections under way, and the things that they are
};

}  // namespace concord
