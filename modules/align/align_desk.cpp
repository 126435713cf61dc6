#include "align/align_desk.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace concord {
namespace {

using State = AlignDesk::Case::State;

bool has_frame(const AgentLayers& layers, const AlignResult::Used& used) {
  const auto it = layers.find(used.agent);
  return it != layers.end() && it->second.frame_id == used.frame_id;
}

tl::unexpected<Error> expired(const std::string& id) {
  return refuse(Code::kExpired, "nothing is kept of alignment " + id + "; ask for it again");
}

void agree(AlignDesk::Case& one) {
  one.accepted = true;
  one.result.open = false;
}

bool is_ahead(const AlignDesk::Case& one) { return one.state == State::kWaiting || one.state == State::kRunning; }

/// Said by the watch, until somebody has put it right.
bool is_standing_offer(const AlignDesk::Case& one) { return one.is_offer && !one.accepted; }

}  // namespace

AlignDesk::Case* AlignDesk::find(const std::string& id) {
  const auto it = std::ranges::find(cases_, id, [](const Case& one) { return one.request.id; });
  return it != cases_.end() ? &*it : nullptr;
}

Result<const AlignDesk::Case*> AlignDesk::find(const std::string& id, std::uint64_t content) const {
  const auto it = std::ranges::find(cases_, id, [](const Case& one) { return one.request.id; });
  if (it == cases_.end()) return nullptr;
  if (it->content == content) return &*it;
  return refuse(Code::kExists, "another request had this id; ids must be unique");
}

std::size_t AlignDesk::ahead_of(const std::string& id) const {
  std::size_t ahead = 0;
  for (const Case& one : cases_) {
    if (one.request.id == id) break;
    ahead += is_ahead(one) ? 1 : 0;
  }
  return ahead;
}

std::size_t AlignDesk::waiting() const { return static_cast<std::size_t>(std::ranges::count_if(cases_, is_ahead)); }

std::size_t AlignDesk::offers() const {
  return static_cast<std::size_t>(std::ranges::count_if(cases_, is_standing_offer));
}

Result<void> AlignDesk::take(AlignRequest request, std::uint64_t content) {
  assert(find(request.id) == nullptr);
  if (waiting() >= kMaxWaiting) {
    return refuse(Code::kBusy, std::to_string(kMaxWaiting) + " alignments wait already; ask again in some seconds");
  }
  Case one;
  one.request = std::move(request);
  one.content = content;
  cases_.push_back(std::move(one));
  return {};
}

const AlignRequest* AlignDesk::begin_next() {
  if (std::ranges::any_of(cases_, [](const Case& one) { return one.state == State::kRunning; })) return nullptr;
  const auto it = std::ranges::find(cases_, State::kWaiting, &Case::state);
  if (it == cases_.end()) return nullptr;
  it->state = State::kRunning;
  return &it->request;
}

const AlignResult* AlignDesk::finish(const AlignTask& task, AlignResult result) {
  Case* one = find(task.id);
  if (one == nullptr || one->state != State::kRunning) return nullptr;
  one->state = State::kDone;
  one->places = places_of(task);
  one->result = std::move(result);
  one->result.id = one->request.id;
  one->result.author = one->request.author;
  one->result.open = one->result.evidence.accepted();
  forget_the_oldest();
  one = find(task.id);
  return one != nullptr ? &one->result : nullptr;
}

bool AlignDesk::give_up(const std::string& id) {
  return std::erase_if(cases_, [&](const Case& one) { return one.request.id == id && one.state == State::kRunning; }) >
         0;
}

/// Of what people asked for. Those that wait are never among them, nor what the watch says: they are few.
void AlignDesk::forget_the_oldest() {
  const auto may_go = [](const Case& one) { return !is_ahead(one) && !is_standing_offer(one); };
  while (std::cmp_greater(std::ranges::count_if(cases_, may_go), kMaxKept)) {
    cases_.erase(std::ranges::find_if(cases_, may_go));
  }
}

const AlignResult* AlignDesk::offer(const AlignTask& task, AlignResult result) {
  withdraw_offer(task.used_source.agent);
  if (dropped_.covers(task, result.evidence)) return nullptr;
  Case one;
  one.request.id = result.id;
  one.request.source = task.used_source.agent;
  one.state = State::kDone;
  one.places = places_of(task);
  one.is_offer = true;
  one.result = std::move(result);
  one.result.open = one.result.evidence.accepted();
  cases_.push_back(std::move(one));
  return &cases_.back().result;
}

void AlignDesk::withdraw_offer(const std::string& agent) {
  std::erase_if(cases_, [&](const Case& one) { return is_standing_offer(one) && one.request.source == agent; });
}

bool AlignDesk::has_offer(const std::string& agent) const {
  return std::ranges::any_of(cases_,
                             [&](const Case& one) { return is_standing_offer(one) && one.request.source == agent; });
}

void AlignDesk::heed(const AgentLayers& layers) {
  for (Case& one : cases_) {
    if (!one.asked || one.accepted) continue;
    if (lies_at({one.asked->agent, one.asked->frame_id, one.asked->T_map_agent}, layers)) agree(one);
  }
  forget_the_oldest();
  dropped_.heed(layers);
  std::erase_if(cases_, [&](const Case& one) {
    return is_standing_offer(one) &&
           !std::ranges::all_of(one.places, [&](const Place& place) { return lies_at(place, layers); });
  });
}

std::vector<std::string> AlignDesk::expire_offers(std::int64_t now) {
  std::vector<std::string> agents;
  for (const Case& one : cases_) {
    if (is_standing_offer(one) && now - one.result.utime > kOpenFor) agents.push_back(one.request.source);
  }
  for (const std::string& agent : agents) withdraw_offer(agent);
  return agents;
}

/// Refused: the map has moved since (kStale), a frame of the target has ended (kBadFrame), it is in no map
/// (kNotAligned).
Result<Transform> AlignDesk::T_map_target(const Case& found, const AgentLayers& layers) const {
  const std::string& target = found.result.target;
  if (target.empty()) {
    for (const Place& place : found.places) {
      if (lies_at(place, layers)) continue;
      return refuse(Code::kStale, place.agent + " lies elsewhere in the map since; align again");
    }
    return Transform::Identity();
  }
  for (const AlignResult::Used& used : found.result.layers) {
    if (!has_frame(layers, used)) return refuse(Code::kBadFrame, used.agent + " has begun another frame; align again");
  }
  const auto& T = layers.at(target).T_map_agent;
  if (T) return *T;
  return refuse(Code::kNotAligned, target + " is in no map itself; align it to the map first");
}

/// Where the source lies in the map once the target does there. Refused: a product beyond what a transform may be.
Result<TransformRequest> AlignDesk::placement(const Case& found, const AlignDecision& decision,
                                              const Transform& T_map_target) {
  const AlignResult& result = found.result;
  const Transform T = T_map_target * result.evidence.T_target_source;
  // As it comes from outside: a product drifts off a rotation, and people may be far away.
  const auto T_map_source = make_transform(T.translation(), Eigen::Quaterniond(T.linear()).coeffs());
  if (!T_map_source) return tl::unexpected(T_map_source.error());
  return TransformRequest{decision.id, decision.author, result.source.agent, result.source.frame_id, *T_map_source};
}

/// One pair alone founds the map: two that lie in no map would each found it in a frame of its own.
Result<AlignDesk::Acceptance> AlignDesk::found_map(Case& found, const AlignDecision& decision) {
  const AlignResult::Used& used = found.result.layers.front();
  if (founding_ && (founding_->is_undone || founding_->align_id != found.request.id)) {
    return refuse(Code::kBusy, founding_->target.agent + " is about to found the map; ask again in a second");
  }
  const auto source = placement(found, decision, Transform::Identity());
  if (!source) return tl::unexpected(source.error());
  // Whoever accepts it as well: the target is placed once, the source in the name of the last.
  if (!founding_) {
    const Transform T = Transform::Identity();
    founding_ = MapFounding{found.request.id,
                            found.result.utime,
                            {founding_id(decision.id), decision.author, used.agent, used.frame_id, T},
                            *source,
                            false};
  }
  founding_->source = *source;
  found.asked = *source;
  return Acceptance{founding_->target, true};
}

Result<AlignDesk::Acceptance> AlignDesk::accept(const AlignDecision& decision, const AgentLayers& layers,
                                                bool is_founded, std::int64_t now) {
  Case* found = find(decision.align_id);
  if (found == nullptr || found->state == State::kDropped) return expired(decision.align_id);
  if (found->state != State::kDone) return refuse(Code::kBusy, "it is not found yet; ask again");
  if (found->accepted) {
    if (found->asked->id == decision.id) return Acceptance{*found->asked, false};
    return refuse(Code::kConflict, "it was accepted by " + found->asked->author + " already");
  }
  const AlignResult& result = found->result;
  if (!result.evidence.accepted()) {
    return refuse(Code::kBadRequest, std::string("it was refused (") + name(result.evidence.reason) +
                                         "); who knows better places the agent with: concord set-transform");
  }
  if (now - result.utime > kOpenFor) return expired(decision.align_id);
  if (!has_frame(layers, result.source)) {
    return refuse(Code::kBadFrame, result.source.agent + " has begun another frame; align again");
  }
  const auto T_map_target = this->T_map_target(*found, layers);
  if (!T_map_target && T_map_target.error().code == Code::kNotAligned && !is_founded) {
    return found_map(*found, decision);
  }
  if (!T_map_target) return tl::unexpected(T_map_target.error());
  auto asked = placement(*found, decision, *T_map_target);
  if (!asked) return tl::unexpected(asked.error());
  found->asked = std::move(*asked);
  if (founding_ && founding_->align_id == decision.align_id) founding_->source = *found->asked;
  return Acceptance{*found->asked, false};
}

void AlignDesk::resume(MapFounding founding) {
  assert(!founding_);
  founding_ = std::move(founding);
}

FoundingStep AlignDesk::go_on_founding(const AgentLayers& layers, bool is_founded, std::int64_t now) {
  if (!founding_) return FoundingStep::kOver;
  const FoundingStep step = next_step(*founding_, layers, is_founded, now, kOpenFor);
  if (step == FoundingStep::kTakeBack) founding_->is_undone = true;
  if (step == FoundingStep::kOver) founding_.reset();
  return step;
}

/// Of the two halves, and of taking the first one back.
void AlignDesk::hear_founding(const std::string& id, bool ok) {
  if (!founding_) return;
  const bool is_source = founding_->source.id == id;
  if ((!ok && founding_->target.id == id) || (ok && is_source) || founding_->taking_back_id() == id) {
    founding_.reset();
  } else if (is_source) {
    founding_->is_undone = true;
  }
}

void AlignDesk::on_merge(const std::string& id, bool ok) {
  hear_founding(id, ok);
  for (Case& one : cases_) {
    if (!one.asked || one.asked->id != id || one.accepted) continue;
    ok ? agree(one) : one.asked.reset();
  }
  forget_the_oldest();
}

Result<void> AlignDesk::drop(const AlignDecision& decision) {
  Case* found = find(decision.align_id);
  if (found == nullptr && dropped_.contains(decision.align_id)) return {};
  if (found == nullptr) return expired(decision.align_id);
  if (found->accepted) {
    return refuse(Code::kConflict, "it was accepted; take it back with: concord undo " + found->asked->id);
  }
  if (found->is_offer) {
    dropped_.add(decision.align_id, found->places.back(), found->result.evidence);
    std::erase_if(cases_, [&](const Case& one) { return one.request.id == decision.align_id; });
    return {};
  }
  if (founding_ && founding_->align_id == decision.align_id) founding_->is_undone = true;
  // It is kept: whoever asked does so again until there is an answer.
  found->state = State::kDropped;
  found->result = {};
  forget_the_oldest();
  return {};
}

std::vector<const AlignResult*> AlignDesk::standing(const AgentLayers& layers, std::int64_t now) {
  std::vector<const AlignResult*> out;
  for (Case& one : cases_) {
    if (one.state != State::kDone || one.accepted) continue;
    if (now - one.result.utime > kOpenFor) one.result.open = false;
    if (one.is_offer || (one.result.open && may_hold(one, layers))) out.push_back(&one.result);
  }
  return out;
}

/// Unless it is said no to for good: the frames are those that it was found in, and the map has not moved since.
bool AlignDesk::may_hold(const Case& found, const AgentLayers& layers) const {
  if (!has_frame(layers, found.result.source)) return false;
  const auto T = T_map_target(found, layers);
  return T || T.error().code == Code::kNotAligned;
}

}  // namespace concord
