#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridge/desk.hpp"
#include "bridge/look_judge.hpp"
#include "bus/brick_stream.hpp"
#include "mapper/map_budget.hpp"

namespace concord::hmd {

/// Clients that are agents: what they scan becomes their submap on the bus, and where they are their pose.
class OwnMaps {
 public:
  /// @param how looks are judged: beside the loop, or within it.
  OwnMaps(Desk& desk, std::launch how, const MapLimits& limits);
  OwnMaps(const OwnMaps&) = delete;
  OwnMaps& operator=(const OwnMaps&) = delete;

  /// Why no client of this role may be this agent: it is a robot, or another process speaks for it.
  [[nodiscard]] std::optional<std::string> not_for_clients(const std::string& agent, Role role) const;
  void begin(const Session& session, bool resumed);
  void tracking(const Session& session);
  void upload(const Ask& ask, PackedFrame frame);
  void send_map(const Ask& ask, const SendMapRequest& request);

 private:
  struct Own {
    Own(const NodeContext& context, const std::string& agent);
    std::shared_ptr<RoomMapper> mapper;  ///< the judge's, while a look waits
    bool anew = false;                   ///< sequences begin anew with the next look
    BrickMap map;                        ///< what has been judged
    std::int64_t occupied = 0;
    std::set<BrickIndex> changed;  ///< since it was published
    std::int64_t boot_id;          ///< of its sender
    BrickSender sender;
    std::string frame_id;  ///< empty: not begun
    std::string over;      ///< a frame of it that was reset
    std::int64_t pose_sent = 0, used = 0;
    std::string identity;          ///< who spoke for it last
    std::size_t mapper_bytes = 0;  ///< after the last look
    bool begun = false;  ///< its sender has said something: until then nothing is void that others have of the agent
  };

  void hear_others();
  void heard_other(const std::string& agent);
  /// Null: there is no room for another agent.
  [[nodiscard]] std::shared_ptr<Own> own_of(const Session& session);
  [[nodiscard]] std::vector<HeldMap> held() const;
  /// Drops those maps. False: there is no room.
  bool leave(const Leaving& leaving);
  /// The map that a client scans into now, or why it may not.
  [[nodiscard]] Granted<std::shared_ptr<Own>> open(const Session& session);
  void publish(Own& own);

  Desk& desk_;
  LookJudge judge_;
  MapLimits limits_;
  std::map<std::string, std::shared_ptr<Own>> by_agent_;
  std::map<std::string, std::int64_t> others_;  ///< agents that other processes speak for, and when they did last
};

}  // namespace concord::hmd
