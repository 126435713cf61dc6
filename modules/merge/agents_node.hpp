#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bus/brick_stream.hpp"
#include "bus/process.hpp"
#include "merge/map_streams.hpp"
#include "merge/people.hpp"
#include "merge/pose_ring.hpp"

namespace concord {

/// Who is there: hears the agents' streams and poses, puts their layers into the map where people placed them, and says
/// who is where.
class AgentsNode {
 public:
  AgentsNode(const NodeContext& context, const People& people, MapStreams& map);

  /// Where a person's work frame lies in the map. Refused: nobody of this name is there (kNoAgent), or not yet after a
  /// restart (kBusy); it is in another frame now (kBadFrame); nobody placed it (kNotAligned).
  [[nodiscard]] Result<Transform> T_map_frame(const WorkFrame& frame) const;

  /// What these requests lead to. Refused: kNoAgent, kBusy, kBadFrame; where some of its layer would lie beyond the map
  /// (kOutOfBounds); for a robot that was seen also no pose of that time (kStale), and what T_map_frame refuses.
  [[nodiscard]] Result<Correction::Placement> check(const TransformRequest& request) const;
  [[nodiscard]] Result<Correction::Placement> check(const LocaliseRequest& request) const;
  [[nodiscard]] Result<Correction::Weight> check(const WeightRequest& request) const;

  /// People placed it, or gave it another weight.
  void follow(const std::string& id);

  /// Every layer that people had put into the map before this start is whole again or, as ingest says of none of them,
  /// gone; or nothing more has arrived for so long that they need not be waited for.
  [[nodiscard]] bool has_all_that_was_aligned() const;

  /// Whether the layers are all there is, as a saved map must hold them. Refused (kBusy): ingest has not been heard for
  /// so long that all its agents were, or the layer of one of them is not whole or not settled.
  [[nodiscard]] Result<void> all_whole() const;

  /// Placements that must be committed, see People::carried_over; they follow on what was made.
  [[nodiscard]] std::vector<Correction> carried_over() const;

  /// What out/agents says of an agent; none: it is not there.
  [[nodiscard]] std::optional<AgentState> state_of(const std::string& id) const;
  /// Of its stream; 0 for an agent that only sends poses. @pre it is there.
  [[nodiscard]] std::int64_t incarnation(const std::string& id) const { return agents_.at(id).incarnation; }

 private:
  struct Agent {
    std::unique_ptr<BrickReceiver> stream;  ///< null for an agent that only sends poses
    std::string frame_id;                   ///< empty: not there
    std::int64_t incarnation = 0;           ///< of the stream; 0 while it has not spoken, and when it has ended
    std::optional<AgentPose> pose;
    std::int64_t pose_heard = 0;
    PoseRing poses;

    [[nodiscard]] bool has_layer() const { return stream && !stream->frame_id().empty(); }
  };

  void listen();
  Agent* agent_called(const std::string& id, const std::string& channel);
  [[nodiscard]] bool make_room();
  void on_ingest(const ProcessStatus& status);
  /// Ingest speaks, and has for so long that all its agents were heard.
  [[nodiscard]] bool all_heard() const;
  BrickReceiver* stream_of_channel(const std::string& channel);
  void open_stream(const std::string& id, Agent& agent);
  void enter_frame(const std::string& id, Agent& agent, const std::string& frame_id);
  void leave(const std::string& id);
  void on_pose(const std::string& channel, AgentPose pose);

  [[nodiscard]] Result<const Agent*> agent_in(const std::string& id, const std::string& frame_id) const;
  [[nodiscard]] Result<Correction::Placement> placement(const std::string& id, const Agent& agent,
                                                        const Transform& T_map_agent) const;
  [[nodiscard]] const Transform* T_map_agent(const std::string& id, const Agent& agent) const;
  [[nodiscard]] int weight_of(const std::string& id) const;
  void publish_agents();
  void publish_pose(const std::string& id, const Agent& agent);

  NodeContext context_;
  const People& people_;
  MapStreams& map_;
  std::map<std::string, Agent> agents_;
  std::set<std::string> awaited_;  ///< had a layer in the map before this start
  std::int64_t last_arrival_;      ///< of a brick, while the map is held back
  struct Ingest {
    std::int64_t boot_id, first, last;  ///< heard, without a long silence between
  };
  std::optional<Ingest> ingest_;
};

}  // namespace concord
