#pragma once

#include <map>
#include <string>

#include "bus/list_stream.hpp"
#include "bus/messages_asset.hpp"
#include "bus/messages_detection.hpp"
#include "bus/messages_label.hpp"
#include "bus/process.hpp"
#include "session/hub.hpp"

namespace concord::hmd {

/// What semantic says of classes, assets and things that were seen; tells clients what waits for a person's word.
class Things {
 public:
  Things(const NodeContext& context, Hub& hub);
  Things(const Things&) = delete;
  Things& operator=(const Things&) = delete;

  [[nodiscard]] const std::vector<concord::Asset>& assets() const { return assets_.items(); }
  /// Null: nothing of this number is known.
  [[nodiscard]] const Thing* thing(std::int64_t number) const;
  /// The classes that show, and their names.
  [[nodiscard]] const std::map<ClassId, std::string>& classes() const { return classes_; }

 private:
  void tell(const std::vector<Thing>& things);

  Hub& hub_;
  std::map<ClassId, std::string> classes_;
  std::map<std::int64_t, std::string> told_;  ///< open detections, and what was said of them
  ListReceiver<concord::Asset> assets_;
  ListReceiver<Thing> things_;
  ListReceiver<LabelSlot> slots_;
};

}  // namespace concord::hmd
