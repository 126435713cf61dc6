#include "agent/cloud_publisher.hpp"

#include <cassert>

#include "bus/messages.hpp"

namespace concord {

CloudPublisher::CloudPublisher(Bus& bus, Counters& counters, const std::string& agent, std::int64_t boot_id,
                               std::function<void()> on_reset)
    : bus_(bus), agent_(agent), boot_id_(boot_id), reset_listener_(bus, counters, agent, std::move(on_reset)) {
  assert(is_name(agent_));
}

void CloudPublisher::begin_frame(const std::string& frame_id) {
  assert(is_name(frame_id));
  frame_id_ = frame_id;
  sequence_ = 0;
  reset_listener_.begin_frame(frame_id);
}

void CloudPublisher::publish(const Transform& T_agent_sensor, double max_range, std::vector<Eigen::Vector3f> points,
                             std::int64_t utime) {
  assert(!frame_id_.empty());
  const Bytes bytes =
      encode(CloudMessage{utime, boot_id_, sequence_++, frame_id_, T_agent_sensor, max_range, std::move(points)});
  bytes_sent_ += static_cast<std::int64_t>(bytes.size());
  bus_.publish("in/" + agent_ + "/cloud", bytes);
}

void CloudPublisher::publish_pose(const Transform& T_agent_base, std::int64_t utime) {
  assert(!frame_id_.empty());
  bus_.publish("in/" + agent_ + "/pose", encode(AgentPose{agent_, frame_id_, T_agent_base, utime}));
}

}  // namespace concord
