#include "ingest/agent_streams.hpp"

namespace concord {

std::unique_ptr<BrickSender> AgentStreams::make(const std::string& id, const BrickMap& layer,
                                                std::int64_t incarnation) {
  // An id may have had a stream before, in this start or an earlier one: the time is an epoch greater than all of its.
  const BrickSender::Config config{"out/agent/" + id, resolution_, pace_, bus_.now(), incarnation};
  return std::make_unique<BrickSender>(bus_, counters_, config, layer);
}

void AgentStreams::tell(const std::string& id, const Agent& agent, const Change& change) {
  auto& sender = live_[id];
  if (sender == nullptr) {
    std::erase_if(ended_, [&](const auto& ended) { return ended.first == id; });
    sender = make(id, agent.layer, agent.incarnation);
    sender->begin(agent.frame_id);
  } else if (change.new_frame) {
    sender->begin(agent.frame_id);
  } else {
    for (const BrickIndex index : change.bricks) sender->touch(index);
  }
}

void AgentStreams::end(const std::string& id) {
  live_.erase(id);
  // A sender of its own, because the layer that the old one reads is about to go.
  ended_.emplace_back(id, make(id, nothing_, 0));
  ended_.back().second->end();
  if (ended_.size() > max_ended_) ended_.pop_front();
}

}  // namespace concord
