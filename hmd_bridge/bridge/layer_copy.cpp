#include "bridge/world.hpp"

namespace concord::hmd {

LayerCopy::LayerCopy(const NodeContext& context, Hub& hub, Config config)
    : context_(context), hub_(hub), config_(std::move(config)) {
  receiver_ = std::make_unique<BrickReceiver>(
      context_.bus, context_.counters,
      BrickReceiver::Config{.stream = config_.stream, .resolution = context_.site.resolution},
      BrickReceiver::Events{.on_frame = [this](const std::string& frame_id) { begin(frame_id); },
                            .on_brick = [this](BrickIndex index, Brick brick) { take(index, std::move(brick)); },
                            .on_end = [this] { begin("ended"); }});
  for (const auto number : {std::optional(config_.number), config_.second}) {
    if (number) hub_.layers().open(*number, config_.levels).epoch = "none";
  }
  const StreamChannels channels(config_.stream);
  listen<BrickPacket>(
      context_.bus, context_.counters, context_.process, channels.bricks,
      [this](const std::string&, const BrickPacket& packet) { receiver_->on_packet(packet); }, alive_);
  listen<BrickDigest>(
      context_.bus, context_.counters, context_.process, channels.digest,
      [this](const std::string&, const BrickDigest& digest) { receiver_->on_digest(digest); }, alive_);
}

LayerCopy::~LayerCopy() = default;

/// A name that no other content has: this process's start, and how many times it began.
void LayerCopy::begin(const std::string& frame_id) {
  map_.clear();
  const std::string epoch = std::to_string(context_.boot_id) + "-" + std::to_string(++begun_) + "-" + frame_id;
  hub_.restart_layer(config_.number, epoch);
  if (config_.second) hub_.restart_layer(*config_.second, epoch);
}

void LayerCopy::take(BrickIndex index, Brick brick) {
  Layers& layers = hub_.layers();
  layers.set(*layers.find(config_.number), index, config_.shown(brick));
  if (config_.second) layers.set(*layers.find(*config_.second), index, config_.shown_second(brick));
  if (config_.keep) map_.set(index, std::move(brick));
}

void LayerCopy::publish() {
  hub_.publish_layer(config_.number, revision(), synced());
  if (config_.second) hub_.publish_layer(*config_.second, revision(), synced());
}

}  // namespace concord::hmd
