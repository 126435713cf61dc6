#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "bus/brick_stream.hpp"
#include "bus/process.hpp"
#include "bus/recent_answers.hpp"
#include "merge/layered_map.hpp"
#include "merge/map_store.hpp"
#include "merge/merge_store.hpp"

namespace concord {

/// The merge process: hears the agents' streams, transforms and edits; says the map, its conflicts and who is where.
class MergeNode {
 public:
  /// @throws std::runtime_error if its store cannot be opened.
  explicit MergeNode(const NodeContext& context);

  [[nodiscard]] const BrickMap& map() const { return layers_.map(); }
  [[nodiscard]] const BrickMap& conflicts() const { return layers_.conflicts(); }

 private:
  struct Agent {
    std::unique_ptr<BrickReceiver> stream;  ///< null for an agent that only sends poses
    std::string frame_id;                   ///< empty: not there, though people may have placed it
    std::int64_t incarnation = 0;           ///< of the stream
    std::map<std::pair<std::string, std::int64_t>, Transform> placed;  ///< by frame and incarnation: as people set it
    std::optional<AgentPose> pose;
    std::int64_t pose_heard = 0;

    [[nodiscard]] const Transform* T_map_agent() const {
      const auto it = placed.find({frame_id, incarnation});
      return it != placed.end() && !frame_id.empty() ? &it->second : nullptr;
    }
  };

  void restore();
  void listen_to_agents();
  void listen_to_people();

  Agent* agent_called(const std::string& id, const std::string& channel);
  BrickReceiver* stream_of_channel(const std::string& channel);
  void open_stream(const std::string& id, Agent& agent);
  void enter_frame(const std::string& id, Agent& agent, const std::string& frame_id);
  void leave(const std::string& id);

  void on_pose(const std::string& channel, AgentPose pose);
  void on_transform(const TransformRequest& request);
  void on_edit(const EditRequest& request);
  void refuse_edit(const std::string& channel, const BadMessage& bad);
  void on_map_request(const MapRequest& request);
  void save(const MapRequest& request);
  void list(const MapRequest& request);

  void refold_and_send();
  void start_map_streams_when_ready();
  [[nodiscard]] bool has_all_that_was_aligned() const;
  void publish_agents();
  void publish_pose(const std::string& id, const Agent& agent);

  [[nodiscard]] Answer granted(const std::string& id, std::int64_t revision, std::int64_t count,
                               const std::string& message) const;
  void deny(const std::string& id, const Error& error);

  NodeContext context_;
  MergeStore store_;
  MapStore maps_;
  LayeredMap layers_;
  BrickSender map_stream_;
  BrickSender conflict_stream_;
  RecentAnswers answers_;
  std::map<std::string, Agent> agents_;
  std::set<std::string> awaited_;  ///< had a layer in the map before this start
  std::int64_t last_arrival_;      ///< of a brick, while the map is held back
  bool streaming_ = false;
};

}  // namespace concord
