#include "semantic/labels/margins_node.hpp"

#include <map>
#include <utility>

#include "semantic/labels/keep_out.hpp"

namespace concord {
namespace {

constexpr std::int64_t kPeriod = 200'000;  ///< zones are told at most so often, microseconds

}  // namespace

MarginsNode::MarginsNode(const NodeContext& context, const Labels& labels, const LabelView& view,
                         std::function<bool()> is_whole)
    : context_(context),
      labels_(labels),
      view_(view),
      is_whole_(std::move(is_whole)),
      list_(context.bus, context.counters, "out/label_zones", context.site.stream.bytes_per_second) {
  context_.bus.every(kPeriod, [this] { tell(); });
}

void MarginsNode::tell() {
  begun_ = begun_ || is_whole_();
  if (!is_stale_ || !begun_) return;
  is_stale_ = false;
  std::map<ClassId, std::string> names;
  for (const auto& [name, terms] : context_.site.classes) {
    if (const auto label = labels_.class_called(name)) names.emplace(*label, name);
  }
  std::vector<KeptClearOf> things;
  if (!names.empty()) {
    for (const auto& [of, voxels] : view_.by_instance([&](InstanceId one) { return names.contains(one.label); })) {
      const std::string& name = names.at(of.label);
      const auto& terms = context_.site.classes.at(name);
      const std::string thing = name + " " + std::to_string(of.instance);
      if (terms.margin > 0.0) things.push_back({thing, voxels, terms.margin});
      if (terms.cost > 0) things.push_back({"near " + thing, voxels, terms.cost_margin, terms.cost});
    }
  }
  list_.set(keep_out_zones(things, context_.site.resolution));
}

}  // namespace concord
