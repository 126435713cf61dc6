#include "semantic/assets/injections.hpp"

#include <algorithm>

#include "core/assets.hpp"

namespace concord {
namespace {

const std::string kOld = ".old@", kBack = ".back@", kGone = "asset.gone@";

using ByEdit = std::map<std::string, Labels::Injected>;

ByEdit by_edit(const Labels& labels) {
  ByEdit out;
  for (Labels::Injected& one : labels.injected()) out.emplace(one.edit_id, std::move(one));
  return out;
}

/// The edit by which it came into the map first.
std::string root_of(const Labels::Injected& injected, const ByEdit& all) {
  const Labels::Injected* at = &injected;
  for (std::size_t steps = 0; steps < all.size(); ++steps) {  // a file may say that two replaced one another
    const auto before = all.find(at->what.replaces);
    if (before == all.end()) break;
    at = &before->second;
  }
  return at->edit_id;
}

}  // namespace

std::map<std::string, Labels::Injected> placed(const Labels& labels) {
  const ByEdit all = by_edit(labels);
  const std::size_t prefix = edit_of_asset("").size();
  std::map<std::string, Labels::Injected> out;
  for (const auto& [edit_id, one] : all) {
    if (!one.edit || !one.edit->active) continue;
    const std::string root = root_of(one, all);
    if (root.size() <= prefix) continue;
    const auto [it, is_first] = out.try_emplace(root.substr(prefix), one);
    if (!is_first && one.edit->revision > it->second.edit->revision) it->second = one;
  }
  return out;
}

std::optional<Labels::Injected> where_is(const std::string& request_id, const Labels& labels) {
  const auto all = placed(labels);
  const auto it = all.find(request_id);
  return it != all.end() ? std::optional(it->second) : std::nullopt;
}

bool has_moved(const Labels::Injected& injected, const Labels& labels) {
  if (injected.what.replaces.empty() || !injected.edit || !injected.edit->active) return true;
  const ByEdit all = by_edit(labels);
  const auto before = all.find(injected.what.replaces);
  return before == all.end() || !before->second.edit || !before->second.edit->active;
}

std::vector<UndoRequest> due(const Labels& labels) {
  const ByEdit all = by_edit(labels);
  std::vector<UndoRequest> out;
  for (const auto& [edit_id, one] : all) {
    const auto before = all.find(one.what.replaces);
    if (before == all.end() || !one.edit || !before->second.edit) continue;
    const Labels::EditState &now = *one.edit, &old = *before->second.edit;
    if (now.by_us || now.active != old.active || now.revision < old.revision) continue;
    const std::string id = edit_id + (now.active ? kOld : kBack) + std::to_string(now.revision);
    out.push_back({id, one.author, before->first, !now.active, 0});
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

std::string moved_by(const std::string& request_id) {
  const std::size_t end = request_id.rfind(kOld);
  return is_ours(request_id) && end != std::string::npos ? request_id.substr(0, end) : std::string();
}

}  // namespace concord
