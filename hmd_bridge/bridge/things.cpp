#include "bridge/things.hpp"

#include <algorithm>

#include "bridge/convert.hpp"

namespace concord::hmd {
namespace {

DetectionEvent event_of(const Thing& thing, bool open) {
  return {std::to_string(thing.number), thing.class_name, to_hmd(thing.T_map_asset), thing.score, thing.author, open};
}

}  // namespace

Things::Things(const NodeContext& context, Hub& hub)
    : hub_(hub),
      assets_(context.bus, context.counters, "out/assets", [](const std::vector<concord::Asset>&) {}),
      things_(context.bus, context.counters, "out/things", [this](const std::vector<Thing>& things) { tell(things); }),
      slots_(context.bus, context.counters, "out/label_slots", [this](const std::vector<LabelSlot>& slots) {
        classes_.clear();
        for (const LabelSlot& slot : slots) classes_[slot.of.label] = slot.name;
      }) {}

const Thing* Things::thing(std::int64_t number) const {
  const auto it = std::ranges::find(things_.items(), number, &Thing::number);
  return it != things_.items().end() ? &*it : nullptr;
}

/// What is decided, or was forgotten, is said once more: who was shown it takes it away.
void Things::tell(const std::vector<Thing>& things) {
  std::map<std::int64_t, std::string> open;
  for (const Thing& thing : things) {
    if (!thing.injection.empty()) continue;
    const std::string text = event_text(event_of(thing, true));
    open.emplace(thing.number, text);
    const auto told = told_.find(thing.number);
    if (told == told_.end() || told->second != text) hub_.tell_all("detection/" + std::to_string(thing.number), text);
  }
  for (const auto& [number, text] : told_) {
    if (open.contains(number)) continue;
    const std::string key = "detection/" + std::to_string(number);
    const auto known = std::ranges::find(things, number, &Thing::number);
    Thing gone;
    gone.number = number;
    hub_.tell_all(key, event_text(event_of(known != things.end() ? *known : gone, false)));
    hub_.forget(key);
  }
  told_ = std::move(open);
}

}  // namespace concord::hmd
