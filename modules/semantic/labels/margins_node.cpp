#include "semantic/labels/margins_node.hpp"

#include <bit>
#include <utility>

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
  if (!begun_) return;
  if (has_new_names_) take_names();
  for (const auto& [tile, bricks] : touched_.sorted()) {
    for (std::uint64_t bits = bricks; bits != 0; bits &= bits - 1) {
      const BrickIndex index = brick_at(tile, std::countr_zero(bits));
      outlines_.set(index, wanted_in(index));
    }
  }
  touched_.clear();
  if (has_told_ && !outlines_.is_stale()) return;
  has_told_ = true;
  list_.set(keep_out_zones(things(), context_.site.resolution));
}

/// Where other classes have terms now, or the same by another name, all begins anew.
void MarginsNode::take_names() {
  has_new_names_ = false;
  std::map<ClassId, std::string> wanted;
  for (const auto& [name, terms] : context_.site.classes) {
    if (const auto label = labels_.class_called(name)) wanted.emplace(*label, name);
  }
  if (wanted == wanted_) return;
  wanted_ = std::move(wanted);
  outlines_.clear();
  for (const BrickIndex index : view_.shown().sorted_bricks()) touched_.insert(index);
}

Outlines::InBrick MarginsNode::wanted_in(BrickIndex index) const {
  Outlines::InBrick out;
  if (wanted_.empty()) return out;
  for (const auto& [of, voxels] : view_.in_brick(index)) {
    if (wanted_.contains(of.label)) out.emplace(of, outline_of(voxels, context_.site.resolution));
  }
  return out;
}

std::vector<KeptClearOf> MarginsNode::things() {
  std::vector<KeptClearOf> out;
  for (const auto& [of, outline] : outlines_.all()) {
    const std::string& name = wanted_.at(of.label);
    const auto& terms = context_.site.classes.at(name);
    const std::string thing = name + " " + std::to_string(of.instance);
    if (terms.margin > 0.0) out.push_back({thing, outline, terms.margin});
    if (terms.cost > 0) out.push_back({"near " + thing, outline, terms.cost_margin, terms.cost});
  }
  return out;
}

}  // namespace concord
