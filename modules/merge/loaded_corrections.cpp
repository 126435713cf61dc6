#include "merge/loaded_corrections.hpp"

#include <algorithm>
#include <map>

#include <xxhash.h>

namespace concord {
namespace {

/// The same for the same request, so that what was done is known when it is asked again.
std::string id_for(const std::string& what, const Loading& loading, const std::string& agent) {
  const std::string text = loading.request_id + '\n' + agent;
  return what + "-" +
         std::to_string(
             XXH3_64bits_withSeed(text.data(), text.size(), static_cast<std::uint64_t>(loading.incarnation)));
}

bool is_of(const Correction::Placement& placement, const LayerHead& head) {
  return placement.agent == head.agent && placement.frame_id == head.frame_id &&
         placement.incarnation == head.incarnation;
}

class Following {
 public:
  Following(const Loading& loading, const People& people) : loading_(loading), people_(people) {}

  Result<void> take_saved() {
    for (const Correction& saved : loading_.archive.corrections) {
      if (is_of_no_layer(std::get_if<Correction::Weight>(&saved.what))) continue;
      Correction correction = saved;
      const LayerHead* head = rekey(correction);
      if (const auto* undo = std::get_if<Correction::Undo>(&saved.what)) note(*undo);
      const People::Made* known = people_.find(saved.id);
      if (known == nullptr) {
        if (head != nullptr) placed_[head->agent].push_back({correction, true});
        append(std::move(correction));
        continue;
      }
      if (known->content != saved.content) {
        return refuse(Code::kExists, "another correction has the id " + saved.id + ", which the map has too");
      }
      if (head != nullptr) placed_[head->agent].push_back({correction, false});
    }
    return {};
  }

  /// What the file's layers are where and how they were.
  void complete(const std::function<int(const std::string&)>& weight_here) {
    for (const SavedLayer& layer : loading_.archive.layers) {
      const LayerHead& head = layer.head;
      const Placed* placed = last_placed(head.agent);
      if (placed != nullptr && !placed->is_new && !is_placed(head)) {
        Correction again = placed->correction;
        again.id = id_for("placed", loading_, head.agent);
        append(std::move(again));
      }
      if (weight_after(head.agent, weight_here) == head.weight) continue;
      append({0, id_for("weight", loading_, head.agent), author_of(head), loading_.utime, 0,
              Correction::Weight{head.agent, head.weight}});
    }
  }

  std::vector<Correction> out;

 private:
  void append(Correction correction) {
    if (const auto* weight = std::get_if<Correction::Weight>(&correction.what)) {
      new_weights_[weight->agent] = weight->weight;
    }
    correction.revision = people_.revision() + 1 + static_cast<std::int64_t>(out.size());
    out.push_back(std::move(correction));
  }

  /// A weight holds for an id: that of an agent which is not in the file would be given to who has the id here.
  [[nodiscard]] bool is_of_no_layer(const Correction::Weight* weight) const {
    return weight != nullptr && std::ranges::none_of(loading_.archive.layers, [&](const SavedLayer& layer) {
             return layer.head.agent == weight->agent;
           });
  }

  /// The layer that a placement is of, after making it one of what the layer has become; null: of none, after making it
  /// nobody's.
  const LayerHead* rekey(Correction& correction) const {
    auto* placement = std::get_if<Correction::Placement>(&correction.what);
    if (placement == nullptr) return nullptr;
    const auto it = std::ranges::find_if(loading_.archive.layers,
                                         [&](const SavedLayer& layer) { return is_of(*placement, layer.head); });
    if (it == loading_.archive.layers.end()) {
      placement->incarnation = kNobodys;
      return nullptr;
    }
    placement->incarnation = loading_.incarnation;
    placement->has_layer = true;
    return &it->head;
  }

  /// Of a layer of the file.
  struct Placed {
    Correction correction;
    bool is_new;  ///< it was not known here
    bool stands = true;
  };

  void note(const Correction::Undo& undo) {
    for (auto& [agent, placements] : placed_) {
      for (Placed& placed : placements) {
        if (placed.correction.id == undo.edit_id) placed.stands = undo.redo;
      }
    }
  }
  /// Where the file has it; null: nowhere.
  [[nodiscard]] const Placed* last_placed(const std::string& agent) const {
    const auto it = placed_.find(agent);
    if (it == placed_.end()) return nullptr;
    const auto last = std::ranges::find(it->second.rbegin(), it->second.rend(), true, &Placed::stands);
    return last != it->second.rend() ? &*last : nullptr;
  }
  [[nodiscard]] bool is_placed(const LayerHead& head) const {
    return people_.T_map_agent(head.agent, head.frame_id, loading_.incarnation) != nullptr;
  }
  [[nodiscard]] int weight_after(const std::string& agent,
                                 const std::function<int(const std::string&)>& weight_here) const {
    const auto it = new_weights_.find(agent);
    return it != new_weights_.end() ? it->second : people_.weight(agent).value_or(weight_here(agent));
  }
  /// Who placed it, if anybody did.
  [[nodiscard]] std::string author_of(const LayerHead& head) const {
    const Placed* placed = last_placed(head.agent);
    return placed != nullptr ? placed->correction.author : std::string();
  }

  const Loading& loading_;
  const People& people_;
  std::map<std::string, std::vector<Placed>> placed_;  ///< by agent, the last one last
  std::map<std::string, int> new_weights_;
};

}  // namespace

Result<std::vector<Correction>> corrections_to_load(const Loading& loading, const People& people, CorrectionCheck ours,
                                                    const std::function<int(const std::string& agent)>& weight_here) {
  Following following(loading, people);
  if (const auto taken = following.take_saved(); !taken) return tl::unexpected(taken.error());
  following.complete(weight_here);
  std::int64_t pins = 0, bricks = 0;
  for (const Correction& correction : following.out) {
    if (const auto follows = ours.take(correction); !follows) return tl::unexpected(follows.error());
    const auto* edit = std::get_if<Correction::Edit>(&correction.what);
    if (edit == nullptr) continue;
    pins += static_cast<std::int64_t>(edit->added.size() + edit->deleted.size());
    bricks += static_cast<std::int64_t>(by_brick(*edit).size());
  }
  if (const auto room = people.edits().check_room(pins, bricks); !room) return tl::unexpected(room.error());
  return std::move(following.out);
}

}  // namespace concord
