#include "merge/map_streams.hpp"

#include <cassert>

namespace concord {
namespace {

BrickSender::Config stream_config(const NodeContext& context, const std::string& stream) {
  return {stream, context.site.resolution, context.site.stream.bytes_per_second, context.boot_id};
}

}  // namespace

MapStreams::MapStreams(const NodeContext& context, const PinMap& pins)
    : layers_(context.site.resolution, context.site.merge.policy, pins),
      map_stream_(context.bus, context.counters, stream_config(context, "out/map"), layers_.map()),
      conflict_stream_(context.bus, context.counters, stream_config(context, "out/conflicts"), layers_.conflicts()) {}

void MapStreams::refold_and_send() {
  const LayeredMap::Changes changes = layers_.refold();
  if (!begun_) return;
  for (const BrickIndex index : changes.map) map_stream_.touch(index);
  for (const BrickIndex index : changes.conflicts) conflict_stream_.touch(index);
  if (!changes.map.empty()) map_stream_.send_now();
  if (!changes.conflicts.empty()) conflict_stream_.send_now();
}

void MapStreams::begin() {
  assert(!begun_);
  map_stream_.begin("map");
  conflict_stream_.begin("map");
  begun_ = true;
}

}  // namespace concord
