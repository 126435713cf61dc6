#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bus/brick_stream.hpp"
#include "bus/list_stream.hpp"
#include "bus/messages_label.hpp"
#include "bus/process.hpp"
#include "session/hub.hpp"

namespace concord::hmd {

/// A copy of the label stream and of what its values mean, as clients see it: a layer of the hub whose frames say which
/// voxel is labelled what.
class LabelCopy {
 public:
  LabelCopy(const NodeContext& context, Hub& hub);
  LabelCopy(const LabelCopy&) = delete;
  LabelCopy& operator=(const LabelCopy&) = delete;

  /// Tells clients what has changed since the last call.
  void publish();

 private:
  void begin(const std::string& frame_id);
  void take(BrickIndex index, Brick brick);
  void take_slots(const std::vector<LabelSlot>& slots);
  [[nodiscard]] BlockStore::Said say(const BlockIndex& block) const;

  NodeContext context_;
  Hub& hub_;
  BrickMap map_;
  std::map<std::int32_t, InstanceId> slots_;
  std::int64_t begun_ = 0;
  ListReceiver<LabelSlot> slot_list_;
  BrickReceiver receiver_;
};

}  // namespace concord::hmd
