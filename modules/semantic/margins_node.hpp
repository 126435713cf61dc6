#pragma once

#include <map>
#include <string>

#include "bus/list_stream.hpp"
#include "bus/process.hpp"
#include "semantic/class_rules.hpp"
#include "semantic/label_view.hpp"

namespace concord {

/// Says zones around things that robots keep away from (`out/label_zones`): by their classes' margins, in
/// STATE/classes.yaml, which is looked at each second. The planner takes them as it takes people's no-go zones.
class MarginsNode {
 public:
  /// Both must outlive this.
  MarginsNode(const NodeContext& context, const Labels& labels, const LabelView& view);
  MarginsNode(const MarginsNode&) = delete;
  MarginsNode& operator=(const MarginsNode&) = delete;

  /// What shows, or what it is called, is another than before.
  void touch() { is_stale_ = true; }
  /// All that shows is whole: before, nothing is said, or a robot would be let through where a label is still to come.
  void begin() { begun_ = true; }

 private:
  void read_rules();
  void tell();

  NodeContext context_;
  const Labels& labels_;
  const LabelView& view_;
  std::map<std::string, ClassRule> rules_;
  ListSender<Zone> list_;
  bool is_stale_ = true;
  bool begun_ = false;
};

}  // namespace concord
