#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/corrections.hpp"
#include "semantic/labels/labels.hpp"

namespace concord {

/// Models in the map, and those that were. One that was moved has a place more each time: an edit in merge, and of the
/// places that one request began just one is to hold, the one that merge was last asked for by a person. Merge undoes
/// and redoes one edit at a time, so semantic asks for the other half; it says in the ids of such requests that it
/// does.
class Injections {
 public:
  explicit Injections(const Labels& labels);

  /// All that are in the map, where they are now, by the ids of the requests that injected them.
  [[nodiscard]] const std::map<std::string, Labels::Injected>& placed() const { return placed_; }

  /// Null: no such edit put a model anywhere.
  [[nodiscard]] const Labels::Injected* by_edit(const std::string& edit_id) const;

  /// Whether nothing is due of what this edit put there: the model has left its other places, or is not there any more.
  [[nodiscard]] bool is_settled(const std::string& edit_id) const;

  /// What must be asked of merge still: that a model leaves all places but its last one, and that it is back in the one
  /// before when a person undid that. The same until merge has done it, to the byte: ids are taken from the revision
  /// that called for it.
  [[nodiscard]] std::vector<UndoRequest> due() const;

 private:
  using Family = std::vector<std::string>;  ///< edits
  [[nodiscard]] const Labels::EditState* state_of(const std::string& edit_id) const;
  [[nodiscard]] std::string active_in(const Family& family) const;
  void find_families();
  void add_due(const Family& family, std::vector<UndoRequest>& out) const;

  std::map<std::string, Labels::Injected> by_edit_;
  std::map<std::string, std::string> root_;  ///< of an edit, the one by which the model came into the map first
  std::map<std::string, Family> families_;   ///< by root
  std::map<std::string, Labels::Injected> placed_;
};

/// The undo that takes a model out of the map for good, not back to where it was.
[[nodiscard]] UndoRequest removal(const std::string& edit_id, const std::string& request_id, const std::string& author);

/// Whether such a request of ours has this id.
[[nodiscard]] bool is_ours(const std::string& request_id);
/// The request that a removal was asked by; empty: this is none.
[[nodiscard]] std::string asked_removal(const std::string& request_id);

/// Merge did not let a model leave a place, or come back to one, as this request of ours asks: the one by which it
/// stays where it was before a person asked for that. Nothing: it is no such request. Its author is for who sends it.
[[nodiscard]] std::optional<UndoRequest> reversal(const std::string& refused_id);

}  // namespace concord
