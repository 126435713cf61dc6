#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "bus/list_stream.hpp"
#include "bus/process.hpp"
#include "core/brick_set.hpp"
#include "semantic/labels/keep_out.hpp"
#include "semantic/labels/label_view.hpp"

namespace concord {

/// Says zones around things that robots keep away from (`out/label_zones`), as the site file has it for their classes.
/// The planner takes them as it takes people's zones. A change costs the bricks in which it is.
class MarginsNode {
 public:
  /// Both must outlive this. Nothing is said before `is_whole` once says that all that shows is whole: a robot would be
  /// let through where a label is still to come.
  MarginsNode(const NodeContext& context, const Labels& labels, const LabelView& view, std::function<bool()> is_whole);
  MarginsNode(const MarginsNode&) = delete;
  MarginsNode& operator=(const MarginsNode&) = delete;

  /// What shows there is another than before.
  void touch(BrickIndex index) { touched_.insert(index); }
  /// A class may be called otherwise.
  void touch_names() { has_new_names_ = true; }

 private:
  void tell();
  void take_names();
  [[nodiscard]] Outlines::InBrick wanted_in(BrickIndex index) const;
  [[nodiscard]] std::vector<KeptClearOf> things();

  NodeContext context_;
  const Labels& labels_;
  const LabelView& view_;
  std::function<bool()> is_whole_;
  ListSender<Zone> list_;
  std::map<ClassId, std::string> wanted_;  ///< classes that the site file has terms for, and what they are called
  Outlines outlines_;                      ///< of their instances
  BrickSet touched_;
  bool has_new_names_ = true;
  bool begun_ = false, has_told_ = false;
};

}  // namespace concord
