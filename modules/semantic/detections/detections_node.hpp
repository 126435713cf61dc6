#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>

#include "bus/messages_detection.hpp"
#include "bus/process.hpp"
#include "bus/recent_answers.hpp"
#include "bus/replies.hpp"
#include "semantic/assets/assets_node.hpp"
#include "semantic/detections/object_fit.hpp"
#include "semantic/detections/sightings.hpp"

namespace concord {

/// What is seen of known objects: refused, proposed to people, or one that is known already. What a person confirms is
/// fitted to the map and injected; what was injected, be it so or by hand, is moved when it is seen elsewhere.
/// Proposals are kept in memory only: who sees says so again.
class DetectionsNode {
 public:
  struct Parts {
    const Labels& labels;
    const BrickMap& map;
    AssetsNode& assets;
    std::function<Result<Transform>(const WorkFrame&)> T_map_frame;
  };
  DetectionsNode(const NodeContext& context, Parts parts);
  DetectionsNode(const DetectionsNode&) = delete;
  DetectionsNode& operator=(const DetectionsNode&) = delete;

 private:
  void on_detection(const Detection& detection);
  void on_decision(const DetectionDecision& decision);
  [[nodiscard]] Result<Sightings::Seen> see(const Detection& detection);
  [[nodiscard]] Result<const Asset*> asset_called(const std::string& name) const;
  void confirm(const DetectionDecision& decision, const Thing& thing);
  void move(const Thing& thing, const Transform& T_map_asset);
  [[nodiscard]] Result<ObjectFit> fitted(const std::string& asset, const Transform& T_map_asset) const;
  void follow_injections();

  NodeContext context_;
  Parts parts_;
  Replies replies_;
  RecentAnswers answers_;
  Sightings sightings_;
  ListSender<Thing> list_;
  std::map<std::string, std::int64_t> confirmed_;  ///< injections under way, and the things that they are
};

}  // namespace concord
