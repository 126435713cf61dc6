#include "semantic/margins_node.hpp"

#include <algorithm>

#include "semantic/keep_out.hpp"

namespace concord {
namespace {

constexpr std::int64_t kPeriod = 200'000;  ///< zones are told at most so often, microseconds
constexpr std::int64_t kReadPeriod = 1'000'000;

}  // namespace

MarginsNode::MarginsNode(const NodeContext& context, const Labels& labels, const LabelView& view)
    : context_(context),
      labels_(labels),
      view_(view),
      list_(context.bus, context.counters, "out/label_zones", context.site.stream.bytes_per_second) {
  read_rules();
  context_.bus.every(kReadPeriod, [this] { read_rules(); });
  context_.bus.every(kPeriod, [this] { tell(); });
}

/// A file that cannot be read leaves what held before: robots are not let nearer by a slip of the pen.
void MarginsNode::read_rules() {
  auto read = read_class_rules(context_.site.state / "classes.yaml");
  if (!read) return context_.counters.refused("classes", read.error());
  const auto same = [](const auto& a, const auto& b) {
    return a.first == b.first && a.second.margin == b.second.margin;
  };
  if (std::ranges::equal(*read, rules_, same)) return;
  rules_ = std::move(*read);
  is_stale_ = true;
}

void MarginsNode::tell() {
  if (!is_stale_ || !begun_) return;
  is_stale_ = false;
  std::vector<KeptClearOf> things;
  for (const auto& [name, rule] : rules_) {
    const auto label = labels_.class_called(name);
    if (!label || rule.margin <= 0.0) continue;
    for (auto& [of, voxels] : view_.by_instance(*label)) {
      things.push_back({name + " " + std::to_string(of.instance), std::move(voxels), rule.margin});
    }
  }
  list_.set(keep_out_zones(things, context_.site.resolution));
}

}  // namespace concord
