// Where labels lie: the half of Labels that goes along with agents.

#include <algorithm>
#include <utility>

#include "semantic/labels/anchor.hpp"
#include "semantic/labels/labels.hpp"

namespace concord {
namespace {

/// Metres, or of a rotation's entries: a placement that is said twice may differ in its last bits.
constexpr double kStep = 1e-9;

/// By the newest placement alone, not by those before it: so where all lies does not depend on what was heard between.
Transform rounded(const Transform& T) {
  Transform out = Transform::Identity();
  out.matrix().topRows<3>() = (T.matrix().topRows<3>() / kStep).array().round() * kStep;
  return out;
}

}  // namespace

bool Labels::is_news(const LabelAnchor& where) const {
  const auto frame = frames_.find({where.agent, where.frame_id});
  if (frame == frames_.end() || frame->second.claims.empty()) return false;
  return !frame->second.T_map_agent || frame->second.T_map_agent->matrix() != rounded(where.T_map_agent).matrix();
}

void Labels::place(const LabelAnchor& where) {
  Frame& frame = frames_[{where.agent, where.frame_id}];
  const Transform now = rounded(where.T_map_agent);
  if (frame.T_map_agent && frame.T_map_agent->matrix() == now.matrix()) return;
  frame.T_map_agent = now;
  for (const std::uint32_t step : frame.claims) {
    steps_[step].is_astray = true;
    if (!std::exchange(steps_[step].is_queued, true)) to_lay_.push_back(step);
  }
}

/// Whether a claim is not undone, and the edit that it came with, if any, holds.
bool Labels::holds(std::uint32_t step) const {
  const Step& kept = steps_[step];
  if (!kept.active || kept.claim.edit_id.empty()) return kept.active;
  const auto edit = edits_.find(kept.claim.edit_id);
  return edit != edits_.end() && edit->second.active;
}

void Labels::lay_if_astray(std::uint32_t step, BrickSet& touched) {
  Step& kept = steps_[step];
  if (!kept.is_astray || !holds(step)) return;
  kept.is_astray = false;
  const LabelAnchor& anchor = kept.claim.anchor;
  lay(step, *frames_.at({anchor.agent, anchor.frame_id}).T_map_agent, touched);
}

bool Labels::lay_some(std::int64_t voxels, BrickSet& touched) {
  for (std::int64_t laid = 0; !to_lay_.empty() && laid < voxels;) {
    const std::uint32_t step = to_lay_.front();
    to_lay_.pop_front();
    steps_[step].is_queued = false;
    if (steps_[step].is_astray && holds(step)) laid += made_[step].count;
    lay_if_astray(step, touched);
  }
  return !to_lay_.empty();
}

/// Takes a claim from the bricks where it lies, and to where it lies from now on.
void Labels::lay(std::uint32_t step, const Transform& T_map_agent, BrickSet& touched) {
  Step& kept = steps_[step];
  const auto& claimed = kept.claimed.empty() ? kept.bricks : kept.claimed;
  auto now = followed(claimed, kept.claim.anchor.T_map_agent, T_map_agent, resolution_).sorted();
  if (now == kept.bricks) return;
  if (kept.active) leave_bricks(step, touched);
  if (kept.claimed.empty()) kept.claimed = std::move(kept.bricks);
  kept.bricks = std::move(now);
  if (kept.active) enter_bricks(step, touched);
}

void Labels::enter_bricks(std::uint32_t step, BrickSet& touched) {
  for (const auto& [index, mask] : steps_[step].bricks) {
    touched.insert(index);
    auto& claims = by_brick_[index];
    claims.insert(std::ranges::lower_bound(claims, step), step);
  }
}

void Labels::leave_bricks(std::uint32_t step, BrickSet& touched) {
  for (const auto& [index, mask] : steps_[step].bricks) {
    touched.insert(index);
    const auto claims = by_brick_.find(index);
    std::erase(claims->second, step);
    if (claims->second.empty()) by_brick_.erase(claims);
  }
}

}  // namespace concord
