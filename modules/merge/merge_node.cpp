#include "merge/merge_node.hpp"

#include <stdexcept>

#include <spdlog/spdlog.h>

namespace concord {
namespace {

constexpr std::int64_t kRefoldPeriod = 20'000;
constexpr std::int64_t kCountPeriod = 1'000'000;

}  // namespace

MergeNode::MergeNode(const NodeContext& context)
    : context_(context),
      store_(context.site.state / "merge.db", context.site.resolution),
      people_(restored()),
      map_(context, people_.pins()),
      agents_(context, people_, map_),
      people_node_(context, store_, people_, map_, agents_),
      maps_node_(context, {store_, people_, map_, agents_, people_node_}),
      reports_node_(context, people_, map_) {
  BrickSet pinned;
  for (const BrickIndex index : people_.pins().sorted_bricks()) pinned.insert(index);
  map_.layers().mark(pinned);
  context_.bus.every(kRefoldPeriod, [this] {
    settle();
    refold_and_send();
  });
  context_.bus.every(kCountPeriod, [this] { count(); });
  refold_and_send();
}

People MergeNode::restored() {
  People people(context_.site.resolution);
  BrickSet touched;
  const auto done = store_.for_each([&](const Correction& correction) -> Result<void> {
    const auto* undo = std::get_if<Correction::Undo>(&correction.what);
    if (undo != nullptr && (people.find(undo->edit_id) == nullptr || people.stands(undo->edit_id) == undo->redo)) {
      return damaged(correction.id + " undoes or redoes what is so already, or is not there");
    }
    people.apply(correction, touched);
    return {};
  });
  if (!done) throw std::runtime_error(done.error().message);
  spdlog::info("restored what people made up to revision {}", people.revision());
  return people;
}

/// Who was placed by its poses now has a layer there: on disk, so that it ends with the layer.
void MergeNode::settle() {
  const auto carried = agents_.carried_over();
  if (carried.empty()) return;
  // What cannot be stored now is tried again: until then it lies there all the same.
  if (const auto done = people_node_.commit(carried); !done) context_.counters.refused("carried_over", done.error());
}

void MergeNode::refold_and_send() {
  map_.refold_and_send();
  if (!map_.begun() && agents_.has_all_that_was_aligned()) map_.begin();
}

void MergeNode::count() {
  context_.counters.set("map_bricks", static_cast<std::int64_t>(map_.layers().map().brick_count()));
  context_.counters.set("map_revision", map_.revision());
  context_.counters.set("edit_revision", people_.revision());
  context_.counters.set("bytes_sent", map_.bytes_sent());
}

}  // namespace concord
