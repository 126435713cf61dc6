#include "semantic/assets/injections.hpp"

#include <algorithm>
#include <set>

#include "core/assets.hpp"

namespace concord {
namespace {

const std::string kOld = ".old@", kBack = ".back@", kGone = "asset.gone@", kRefused = ".refused";

}  // namespace

Injections::Injections(const Labels& labels) {
  for (Labels::Injected& one : labels.injected()) by_edit_.emplace(one.edit_id, std::move(one));
  find_families();
  const std::size_t prefix = edit_of_asset("").size();
  for (const auto& [root, family] : families_) {
    const std::string there = active_in(family);
    if (!there.empty() && root.size() > prefix) placed_.emplace(root.substr(prefix), by_edit_.at(there));
  }
}

/// A file may say that two replaced one another: they are one family, as any others that hang together.
void Injections::find_families() {
  for (const auto& [edit_id, one] : by_edit_) {
    std::set<std::string> walked;
    std::string at = edit_id;
    while (!root_.contains(at) && walked.insert(at).second) {
      const std::string& before = by_edit_.at(at).what.replaces;
      if (!by_edit_.contains(before)) break;
      at = before;
    }
    const std::string root = root_.contains(at) ? root_.at(at) : at;
    for (const std::string& step : walked) root_[step] = root;
  }
  for (const auto& [edit_id, root] : root_) families_[root].push_back(edit_id);
}

const Labels::Injected* Injections::by_edit(const std::string& edit_id) const {
  const auto it = by_edit_.find(edit_id);
  return it != by_edit_.end() ? &it->second : nullptr;
}

const Labels::EditState* Injections::state_of(const std::string& edit_id) const {
  const Labels::Injected* one = by_edit(edit_id);
  return one != nullptr && one->edit ? &*one->edit : nullptr;
}

/// The place that it came to last, of those that it has; empty: none.
std::string Injections::active_in(const Family& family) const {
  std::string last;
  for (const std::string& edit_id : family) {
    const Labels::EditState* state = state_of(edit_id);
    if (state == nullptr || !state->active) continue;
    if (last.empty() || state->revision > state_of(last)->revision) last = edit_id;
  }
  return last;
}

bool Injections::is_settled(const std::string& edit_id) const {
  const Labels::EditState* state = state_of(edit_id);
  if (state == nullptr || !state->active) return true;
  return std::ranges::count_if(families_.at(root_.at(edit_id)), [this](const std::string& other) {
           const Labels::EditState* there = state_of(other);
           return there != nullptr && there->active;
         }) == 1;
}

void Injections::add_due(const Family& family, std::vector<UndoRequest>& out) const {
  const std::string there = active_in(family);
  if (!there.empty()) {
    const Labels::Injected& kept = by_edit_.at(there);
    for (const std::string& edit_id : family) {
      const Labels::EditState* state = state_of(edit_id);
      if (edit_id == there || state == nullptr || !state->active) continue;
      const std::string id = there + kOld + std::to_string(kept.edit->revision) + "-" + std::to_string(state->revision);
      out.push_back({id, kept.author, edit_id, false, 0});
    }
    return;
  }
  const Labels::Injected* last = nullptr;
  for (const std::string& edit_id : family) {
    const Labels::Injected& one = by_edit_.at(edit_id);
    if (one.edit && (last == nullptr || one.edit->revision > last->edit->revision)) last = &one;
  }
  if (last == nullptr || last->edit->by_us || state_of(last->what.replaces) == nullptr) return;
  out.push_back(
      {last->edit_id + kBack + std::to_string(last->edit->revision), last->author, last->what.replaces, true, 0});
}

std::vector<UndoRequest> Injections::due() const {
  std::vector<UndoRequest> out;
  for (const auto& [root, family] : families_) {
    if (family.size() > 1) add_due(family, out);
  }
  return out;
}

UndoRequest removal(const std::string& edit_id, const std::string& request_id, const std::string& author) {
  return {kGone + request_id, author, edit_id, false, 0};
}

bool is_ours(const std::string& request_id) {
  return request_id.starts_with(kGone) ||
         (request_id.starts_with(edit_of_asset("")) &&
          (request_id.find(kOld) != std::string::npos || request_id.find(kBack) != std::string::npos));
}

std::string asked_removal(const std::string& request_id) {
  return request_id.starts_with(kGone) ? request_id.substr(kGone.size()) : std::string();
}

std::optional<UndoRequest> reversal(const std::string& refused_id) {
  if (!is_ours(refused_id) || refused_id.ends_with(kRefused)) return std::nullopt;
  const std::size_t old = refused_id.rfind(kOld), back = refused_id.rfind(kBack);
  const bool was_to_leave = old != std::string::npos && (back == std::string::npos || old > back);
  const std::size_t end = was_to_leave ? old : back;
  if (end == std::string::npos) return std::nullopt;  // a removal
  return UndoRequest{refused_id + kRefused, "", refused_id.substr(0, end), !was_to_leave, 0};
}

}  // namespace concord
