#include "semantic/labels/labels.hpp"

#include <algorithm>
#include <cassert>

namespace concord {
namespace {

using Claim = LabelCorrection::Claim;
using Rename = LabelCorrection::Rename;
using Reassign = LabelCorrection::Reassign;
using TakeOff = LabelCorrection::TakeOff;
using Undo = LabelCorrection::Undo;

}  // namespace

struct Labels::Apply {
  Labels& labels;
  std::uint32_t step;
  Made& made;
  BrickSet& touched;

  void operator()(const Claim& claim) const {
    Step& kept = labels.steps_[step];
    kept.is_claim = true;
    kept.claim = {claim.of, claim.class_name, {}, claim.edit_id, claim.anchor, claim.injection};
    kept.bricks = masks_of(claim.voxels).sorted();
    if (!claim.class_name.empty()) labels.classes_[claim.of.label].name = claim.class_name;
    labels.give(claim.of);
    labels.claims_[claim.of].push_back(step);
    made.of = claim.of;
    made.count = static_cast<std::int64_t>(claim.voxels.size());
    labels.voxels_ever_ += made.count;
    labels.bricks_ever_ += static_cast<std::int64_t>(kept.bricks.size());
    if (claim.edit_id.empty()) {
      labels.voxels_ += made.count;
    } else {
      add_injection(claim);
    }
    labels.enter_bricks(step, touched);
    if (claim.anchor.agent.empty()) return;
    Frame& frame = labels.frames_[{claim.anchor.agent, claim.anchor.frame_id}];
    frame.claims.push_back(step);
    if (frame.T_map_agent) labels.lay(step, *frame.T_map_agent, touched);
  }
  void switch_claim(std::uint32_t claim, bool redo) const {
    if (redo) {
      labels.enter_bricks(claim, touched);
    } else {
      labels.leave_bricks(claim, touched);
    }
    if (!labels.steps_[claim].claim.edit_id.empty()) {
      ++labels.injected_revision_;
    } else {
      labels.voxels_ += (redo ? 1 : -1) * labels.made_[claim].count;
    }
  }
  void add_injection(const Claim& claim) const {
    labels.by_edit_[claim.edit_id].push_back(step);
    if (!labels.edits_.contains(claim.edit_id)) labels.unsaid_.insert(claim.edit_id);
    if (!claim.injection.replaces.empty()) labels.moved_voxels_ += made.count;
    ++labels.injected_revision_;
  }
  void operator()(const Rename& rename) const {
    labels.renames_.push_back(step);
    labels.classes_.at(rename.label).name = rename.name;
    made.of.label = rename.label;
  }
  void operator()(const Reassign& reassign) const {
    labels.give(reassign.to);
    labels.changes_[reassign.from].push_back(step);
    labels.sources_[reassign.to].insert(reassign.from);
    labels.touch(reassign.from, touched);
    made.of = reassign.to;
  }
  void operator()(const TakeOff& take_off) const {
    labels.changes_[take_off.of].push_back(step);
    labels.touch(take_off.of, touched);
    made.of = take_off.of;
  }
  void operator()(const Undo& undo) const {
    const std::uint32_t subject = labels.by_id_.at(undo.correction_id);
    Step& kept = labels.steps_[subject];
    made.of = labels.made_[subject].of;
    if (kept.is_claim && kept.active != undo.redo) switch_claim(subject, undo.redo);
    kept.active = undo.redo;
    labels.lay_if_astray(subject, touched);
    if (const auto* reassign = std::get_if<Reassign>(&kept.what)) labels.touch(reassign->from, touched);
    if (const auto* take_off = std::get_if<TakeOff>(&kept.what); take_off != nullptr && !kept.is_claim) {
      labels.touch(take_off->of, touched);
    }
    if (!std::holds_alternative<Rename>(kept.what)) return;
    for (const auto& [id, name] : labels.names_if(subject, undo.redo)) labels.classes_.at(id).name = name;
  }
};

void Labels::apply(const LabelCorrection& correction, BrickSet& touched) {
  assert(correction.revision > revision() && !by_id_.contains(correction.id));
  const auto step = static_cast<std::uint32_t>(steps_.size());
  by_id_[correction.id] = step;
  made_.push_back({correction.id, correction.author, correction.utime, correction.revision, correction.content, {}, 0});
  steps_.push_back({});
  if (!std::holds_alternative<Claim>(correction.what)) steps_.back().what = correction.what;
  std::visit(Apply{*this, step, made_.back(), touched}, correction.what);
}

void Labels::set_edit(const std::string& edit_id, const EditState& state, BrickSet& touched) {
  const auto [it, is_new] = edits_.try_emplace(edit_id, state);
  const bool was_active = !is_new && it->second.active;
  it->second = state;
  unsaid_.erase(edit_id);
  if (was_active == state.active) return;
  const auto steps = by_edit_.find(edit_id);
  if (steps == by_edit_.end()) return;
  for (const std::uint32_t step : steps->second) {
    lay_if_astray(step, touched);
    for (const auto& [index, mask] : steps_[step].bricks) touched.insert(index);
  }
}

std::vector<Labels::Injected> Labels::injected() const {
  std::vector<Injected> out;
  for (const auto& [edit_id, steps] : by_edit_) {
    const Step& step = steps_[steps.front()];
    if (!step.active) continue;
    const Made& made = made_[steps.front()];
    const auto edit = edits_.find(edit_id);
    out.push_back({made.id, edit_id, made.author, step.claim.of, step.claim.injection,
                   edit != edits_.end() ? std::optional(edit->second) : std::nullopt, made.count});
  }
  return out;
}

std::vector<Labels::Waiting> Labels::waiting(std::size_t most) const {
  std::vector<Waiting> out;
  for (auto it = unsaid_.begin(); it != unsaid_.end() && out.size() < most; ++it) {
    if (auto one = waiting_for(*it)) out.push_back(std::move(*one));
  }
  return out;
}

std::optional<Labels::Waiting> Labels::waiting_for(const std::string& edit_id) const {
  const auto steps = by_edit_.find(edit_id);
  if (steps == by_edit_.end() || edits_.contains(edit_id)) return std::nullopt;
  for (const std::uint32_t step : steps->second) {
    if (!steps_[step].active) continue;
    BrickMasks voxels;
    for (const auto& [index, mask] : steps_[step].bricks) voxels.insert(index, mask);
    const Made& made = made_[step];
    return Waiting{made.id, edit_id, made.author, made.utime, voxels.voxels()};
  }
  return std::nullopt;
}

void Labels::give(InstanceId of) {
  if (classes_[of.label].given.insert(of.instance).second) ++instances_;
}

/// All that may change when something happens to an instance, or to a class (instance 0).
void Labels::touch(InstanceId of, BrickSet& touched) const {
  if (of.instance != 0) return touched.insert(bricks_of(of));
  for (auto it = claims_.lower_bound({of.label, 0}); it != claims_.end() && it->first.label == of.label; ++it) {
    touched.insert(bricks_of(it->first));
  }
  for (auto it = sources_.lower_bound({of.label, 0}); it != sources_.end() && it->first.label == of.label; ++it) {
    touched.insert(bricks_of(it->first));
  }
}

std::set<InstanceId> Labels::with_sources(InstanceId of) const {
  std::vector<InstanceId> open{of};
  std::set<InstanceId> out;
  while (!open.empty()) {
    const InstanceId at = open.back();
    open.pop_back();
    if (!out.insert(at).second) continue;
    if (const auto from = sources_.find(at); from != sources_.end()) {
      open.insert(open.end(), from->second.begin(), from->second.end());
    }
  }
  return out;
}

BrickSet Labels::bricks_of(InstanceId of) const {
  BrickSet out;
  // What was reassigned to it was claimed for another.
  for (const InstanceId source : with_sources(of)) {
    const auto claims = claims_.find(source);
    if (claims == claims_.end()) continue;
    for (const std::uint32_t step : claims->second) {
      for (const auto& [index, mask] : steps_[step].bricks) out.insert(index);
    }
  }
  return out;
}

std::optional<Injection> Labels::model_of(InstanceId of) const {
  std::optional<Injection> last;
  std::int64_t since = 0;
  for (const InstanceId source : with_sources(of)) {
    const auto claims = claims_.find(source);
    if (claims == claims_.end()) continue;
    for (const std::uint32_t step : claims->second) {
      const LabelCorrection::Claim& claim = steps_[step].claim;
      if (claim.edit_id.empty() || holder_of(step) != of) continue;
      const std::int64_t revision = edits_.at(claim.edit_id).revision;
      if (last && revision < since) continue;
      since = revision;
      last = claim.injection;
    }
  }
  return last;
}

std::optional<InstanceId> Labels::holder_of(std::uint32_t claim) const {
  const std::string& edit_id = steps_[claim].claim.edit_id;
  if (!edit_id.empty()) {
    const auto edit = edits_.find(edit_id);
    if (edit == edits_.end() || !edit->second.active) return std::nullopt;
  }
  return owner_of(claim);
}

std::optional<InstanceId> Labels::owner_of(const std::string& claim_id) const {
  const auto it = by_id_.find(claim_id);
  return it != by_id_.end() && steps_[it->second].is_claim ? owner_of(it->second) : std::nullopt;
}

std::optional<InstanceId> Labels::owner_of(std::uint32_t claim) const {
  const Step& step = steps_[claim];
  if (!step.active) return std::nullopt;
  InstanceId holder = step.claim.of;
  for (std::uint32_t after = claim;;) {
    // The first active change after it that concerns its holder, or the holder's class.
    std::optional<std::uint32_t> next;
    for (const InstanceId key : {holder, InstanceId{holder.label, 0}}) {
      const auto changes = changes_.find(key);
      if (changes == changes_.end()) continue;
      for (auto it = std::ranges::upper_bound(changes->second, after); it != changes->second.end(); ++it) {
        if (!steps_[*it].active) continue;
        next = next ? std::min(*next, *it) : *it;
        break;
      }
    }
    if (!next) return holder;
    const auto* reassign = std::get_if<Reassign>(&steps_[*next].what);
    if (reassign == nullptr) return std::nullopt;  // taken off
    holder = reassign->to;
    after = *next;
  }
}

std::optional<InstanceId> Labels::at(VoxelIndex voxel) const {
  VoxelMask just_it{};
  const int local = local_of(voxel);
  just_it[static_cast<std::size_t>(local / 64)] = std::uint64_t{1} << (local % 64);
  const auto found = shares(brick_of(voxel), just_it);
  return found.empty() ? std::nullopt : std::optional(found.front().of);
}

std::vector<Labels::Share> Labels::shares(BrickIndex index, const VoxelMask& of_these) const {
  const auto claims = by_brick_.find(index);
  if (claims == by_brick_.end()) return {};
  std::map<InstanceId, VoxelMask> by_holder;
  VoxelMask open = of_these;  // whose nobody is yet
  for (auto it = claims->second.rbegin(); it != claims->second.rend() && open != VoxelMask{}; ++it) {
    const auto holder = holder_of(*it);
    if (!holder) continue;
    const auto& bricks = steps_[*it].bricks;
    const auto own = std::ranges::lower_bound(bricks, index, {}, [](const auto& entry) { return entry.first; });
    VoxelMask& mask = by_holder[*holder];
    for (std::size_t word = 0; word < mask.size(); ++word) {
      mask[word] |= own->second[word] & open[word];
      open[word] &= ~own->second[word];
    }
  }
  std::vector<Share> out;
  for (const auto& [of, mask] : by_holder) {
    if (mask != VoxelMask{}) out.push_back({of, mask});
  }
  return out;
}

const Labels::Made* Labels::find(const std::string& id) const {
  const auto it = by_id_.find(id);
  return it != by_id_.end() ? &made_[it->second] : nullptr;
}

std::optional<ClassId> Labels::class_called(const std::string& name) const {
  for (const auto& [id, of_class] : classes_) {
    if (of_class.name == name) return id;
  }
  return std::nullopt;
}

std::vector<BrickIndex> Labels::sorted_bricks() const {
  std::vector<BrickIndex> out;
  for (const auto& [index, claims] : by_brick_) out.push_back(index);
  std::ranges::sort(out);
  return out;
}

/// What classes are called if this step is, or is not, active.
std::map<ClassId, std::string> Labels::names_if(std::uint32_t step, bool active) const {
  std::map<ClassId, std::string> names;
  for (const auto& kept : steps_) {
    if (kept.is_claim && !kept.claim.class_name.empty()) names[kept.claim.of.label] = kept.claim.class_name;
  }
  for (const std::uint32_t rename : renames_) {
    const bool holds = rename == step ? active : steps_[rename].active;
    const auto& what = std::get<Rename>(steps_[rename].what);
    if (holds) names[what.label] = what.name;
  }
  return names;
}

}  // namespace concord
