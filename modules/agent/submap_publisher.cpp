#include "agent/submap_publisher.hpp"

#include <cassert>

#include "bus/messages.hpp"

namespace concord {

SubmapPublisher::SubmapPublisher(Bus& bus, Counters& counters, Config config, std::function<void()> on_reset)
    : bus_(bus),
      agent_(config.agent),
      sender_(bus, counters, {"in/" + config.agent, config.resolution, config.bytes_per_second, config.boot_id},
              submap_),
      reset_listener_(bus, counters, config.agent, std::move(on_reset)) {
  assert(is_name(agent_));
}

void SubmapPublisher::begin_frame(const std::string& frame_id) {
  assert(is_name(frame_id));
  frame_id_ = frame_id;
  submap_.clear();
  sender_.begin(frame_id);
  reset_listener_.begin_frame(frame_id);
}

std::size_t SubmapPublisher::publish(const BrickMap& submap) {
  std::size_t changed = 0;
  for (const BrickIndex index : submap_.sorted_bricks()) {
    if (submap.find(index) == nullptr && publish_brick(index, Brick())) ++changed;
  }
  for (const BrickIndex index : submap.sorted_bricks()) {
    const Brick& brick = *submap.find(index);
    const Brick* before = submap_.find(index);
    if (before != nullptr && *before == brick) continue;
    if (publish_brick(index, brick)) ++changed;
  }
  return changed;
}

bool SubmapPublisher::publish_brick(BrickIndex index, Brick brick) {
  assert(!frame_id_.empty());
  if (!submap_.set(index, std::move(brick))) return false;
  sender_.touch(index);
  return true;
}

void SubmapPublisher::publish_pose(const Transform& T_agent_base, std::int64_t utime) {
  assert(!frame_id_.empty());
  bus_.publish("in/" + agent_ + "/pose", encode(AgentPose{agent_, frame_id_, T_agent_base, utime}));
}

}  // namespace concord
