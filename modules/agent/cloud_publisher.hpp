#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "agent/reset_listener.hpp"
#include "core/transform.hpp"

namespace concord {

/// For robots that keep no map: their point clouds, which ingest integrates for them. A cloud that is lost on the way
/// stays lost (ingest counts it); whoever has a map sends that instead (submap_publisher.hpp).
class CloudPublisher {
 public:
  /// `agent` is the id in the site file: is_name(). `boot_id` and `on_reset` as in SubmapPublisher.
  CloudPublisher(Bus& bus, Counters& counters, const std::string& agent, std::int64_t boot_id,
                 std::function<void()> on_reset);

  /// A new frame, at the start and whenever the robot's odometry begins anew. The same id after a restart says that
  /// clouds go on adding to what is there. @pre is_name(frame_id).
  void begin_frame(const std::string& frame_id);

  /// Points in the agent's frame; those beyond `max_range` (metres, 0: none) only free the space up to it.
  /// At most about 5000 points fit one datagram, more come in fragments of which none may be lost.
  /// @pre begin_frame was called.
  void publish(const Transform& T_agent_sensor, double max_range, std::vector<Eigen::Vector3f> points,
               std::int64_t utime);
  /// See SubmapPublisher. @pre begin_frame was called.
  void publish_pose(const Transform& T_agent_base, std::int64_t utime);

  [[nodiscard]] std::int64_t bytes_sent() const { return bytes_sent_; }

 private:
  Bus& bus_;
  std::string agent_;
  std::int64_t boot_id_;
  std::string frame_id_;
  std::int64_t sequence_ = 0;
  std::int64_t bytes_sent_ = 0;
  ResetListener reset_listener_;
};

}  // namespace concord
