#pragma once

#include <functional>

#include "bus/list_stream.hpp"
#include "bus/process.hpp"
#include "semantic/labels/label_view.hpp"

namespace concord {

/// Says zones around things that robots keep away from (`out/label_zones`), as the site file has it for their classes.
/// The planner takes them as it takes people's zones.
class MarginsNode {
 public:
  /// Both must outlive this. Nothing is said before `is_whole` once says that all that shows is whole: a robot would be
  /// let through where a label is still to come.
  MarginsNode(const NodeContext& context, const Labels& labels, const LabelView& view, std::function<bool()> is_whole);
  MarginsNode(const MarginsNode&) = delete;
  MarginsNode& operator=(const MarginsNode&) = delete;

  /// What shows, or what it is called, is another than before.
  void touch() { is_stale_ = true; }

 private:
  void tell();

  NodeContext context_;
  const Labels& labels_;
  const LabelView& view_;
  std::function<bool()> is_whole_;
  ListSender<Zone> list_;
  bool is_stale_ = true;
  bool begun_ = false;
};

}  // namespace concord
