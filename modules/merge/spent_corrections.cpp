#include "merge/spent_corrections.hpp"

#include <map>
#include <utility>
#include <vector>

namespace concord {
namespace {

/// Goes through the list as if what is not spent were done here.
class Spending {
 public:
  explicit Spending(const People& people) : people_(people) {}

  void take(const Correction& correction) {
    const bool is_new = people_.find(correction.id) == nullptr;
    if (const auto* undo = std::get_if<Correction::Undo>(&correction.what); undo != nullptr && is_new) {
      take(correction.id, *undo);
    } else if (const auto* change = std::get_if<Correction::ZoneChange>(&correction.what)) {
      take(correction.id, *change, is_new);
    }
  }

  std::set<std::string> spent;

 private:
  /// What was done to a zone in the file from its addition on, by id, as far as it is new here.
  using Life = std::vector<std::pair<std::string, ZoneRequest::Op>>;

  void take(const std::string& id, const Correction::Undo& undo) {
    bool& stands = edits_.try_emplace(undo.edit_id, people_.stands(undo.edit_id).value_or(true)).first->second;
    if (stands == undo.redo) spent.insert(id);
    stands = undo.redo;
  }

  void take(const std::string& id, const Correction::ZoneChange& change, bool is_new) {
    Life& life = lives_[change.zone.name];
    if (is_new) life.emplace_back(id, change.op);
    if (change.op != ZoneRequest::Op::kDelete) return;
    end(change.zone.name, life);
    lives_.erase(change.zone.name);
  }

  /// A zone is gone in the file: all of its changes can be done here, or none needs to be.
  void end(const std::string& name, const Life& life) {
    bool& is_there = zones_.try_emplace(name, people_.zones().contains(name)).first->second;
    bool after = is_there;
    for (const auto& [id, op] : life) {
      if (after == (op == ZoneRequest::Op::kAdd)) {
        for (const auto& change : life) spent.insert(change.first);
        return;
      }
      after = op != ZoneRequest::Op::kDelete;
    }
    is_there = after;
  }

  const People& people_;
  std::map<std::string, bool> edits_;  ///< id, whether it stands
  std::map<std::string, bool> zones_;  ///< name, whether it is there
  std::map<std::string, Life> lives_;  ///< by name, of zones that stand in the file
};

}  // namespace

std::set<std::string> spent_corrections(std::span<const Correction> saved, const People& people) {
  Spending spending(people);
  for (const Correction& correction : saved) spending.take(correction);
  return std::move(spending.spent);
}

}  // namespace concord
