#include "align/align_desk.hpp"

#include <algorithm>
#include <cassert>

namespace concord {
namespace {

using State = AlignDesk::Case::State;

constexpr std::size_t kLongestStem = 70;  // of an id of 80 characters

/// Of the placement that founds the map, before the one that the decision asks for.
std::string founding_id(const std::string& id) {
  return (id.size() <= kLongestStem ? id : id.substr(id.size() - kLongestStem)) + ".target";
}

bool has_frame(const AgentLayers& layers, const AlignResult::Used& used) {
  const auto it = layers.find(used.agent);
  return it != layers.end() && it->second.frame_id == used.frame_id;
}

bool lies_at(const AgentLayers& layers, const std::string& agent, const Transform& T_map_agent) {
  const auto it = layers.find(agent);
  return it != layers.end() && it->second.T_map_agent && it->second.T_map_agent->isApprox(T_map_agent, 1e-9);
}

tl::unexpected<Error> expired(const std::string& id) {
  return refuse(Code::kExpired, "nothing is kept of alignment " + id + "; ask for it again");
}

std::vector<std::pair<std::string, Transform>> places_in(const AlignTask& task) {
  std::vector<std::pair<std::string, Transform>> places;
  if (!task.target_agent.empty()) return places;
  for (const AlignTask::Part& part : task.target) places.emplace_back(part.agent, part.T_target_part);
  return places;
}

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
    if (one.state != State::kDone) ++ahead;
  }
  return ahead;
}

std::size_t AlignDesk::waiting() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(cases_, [](const Case& one) { return one.state != State::kDone; }));
}

std::size_t AlignDesk::offers() const {
  return static_cast<std::size_t>(std::ranges::count_if(cases_, &Case::is_offer));
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
  one->placed = places_in(task);
  one->result = std::move(result);
  one->result.id = one->request.id;
  one->result.author = one->request.author;
  one->result.open = one->result.evidence.accepted();
  forget_the_oldest();
  one = find(task.id);
  return one != nullptr ? &one->result : nullptr;
}

void AlignDesk::give_up(const std::string& id) {
  std::erase_if(cases_, [&](const Case& one) { return one.request.id == id; });
}

/// Those that wait are never among them: they are few.
void AlignDesk::forget_the_oldest() {
  while (cases_.size() - waiting() > kMaxKept) {
    cases_.erase(std::ranges::find(cases_, State::kDone, &Case::state));
  }
}

const AlignResult& AlignDesk::offer(const AlignTask& task, AlignResult result) {
  withdraw_offer(task.used_source.agent);
  Case one;
  one.request.id = result.id;
  one.request.source = task.used_source.agent;
  one.state = State::kDone;
  one.placed = places_in(task);
  one.is_offer = true;
  one.result = std::move(result);
  one.result.open = one.result.evidence.accepted();
  cases_.push_back(std::move(one));
  forget_the_oldest();
  return cases_.back().result;
}

void AlignDesk::withdraw_offer(const std::string& agent) {
  std::erase_if(cases_, [&](const Case& one) { return one.is_offer && !one.accepted && one.request.source == agent; });
}

bool AlignDesk::has_offer(const std::string& agent) const {
  return std::ranges::any_of(cases_, [&](const Case& one) { return one.is_offer && one.request.source == agent; });
}

/// Refused: the map has moved since (kStale), a frame of the target has ended (kBadFrame), it is in no map
/// (kNotAligned).
Result<Transform> AlignDesk::T_map_target(const Case& found, const AgentLayers& layers) const {
  const std::string& target = found.result.target;
  if (target.empty()) {
    for (const auto& [agent, T_map_agent] : found.placed) {
      if (lies_at(layers, agent, T_map_agent)) continue;
      return refuse(Code::kStale, agent + " lies elsewhere in the map since; align again");
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

Result<AlignDesk::Acceptance> AlignDesk::accept(const AlignDecision& decision, const AgentLayers& layers,
                                                std::int64_t now) {
  Case* found = find(decision.align_id);
  if (found == nullptr) return expired(decision.align_id);
  if (found->state != State::kDone) return refuse(Code::kBusy, "it is not found yet; ask again");
  if (found->accepted) {
    if (found->accepted->id == decision.id) return Acceptance{*found->accepted, false};
    return refuse(Code::kConflict, "it was accepted by " + found->accepted->author + " already");
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
  const bool is_empty =
      std::ranges::none_of(layers, [](const auto& entry) { return entry.second.T_map_agent.has_value(); });
  if (!T_map_target && T_map_target.error().code == Code::kNotAligned && is_empty) {
    const AlignResult::Used& used = result.layers.front();
    return Acceptance{{founding_id(decision.id), decision.author, used.agent, used.frame_id, Transform::Identity()},
                      true};
  }
  if (!T_map_target) return tl::unexpected(T_map_target.error());
  const Transform T = *T_map_target * result.evidence.T_target_source;
  // As it comes from outside: a product drifts off a rotation, and people may be far away.
  const auto T_map_source = make_transform(T.translation(), Eigen::Quaterniond(T.linear()).coeffs());
  if (!T_map_source) return tl::unexpected(T_map_source.error());
  found->accepted =
      TransformRequest{decision.id, decision.author, result.source.agent, result.source.frame_id, *T_map_source};
  found->result.open = false;
  return Acceptance{*found->accepted, false};
}

Result<void> AlignDesk::drop(const AlignDecision& decision) {
  const Case* found = find(decision.align_id);
  if (found == nullptr) return expired(decision.align_id);
  if (found->accepted) {
    return refuse(Code::kConflict, "it was accepted; take it back with: concord undo " + found->accepted->id);
  }
  give_up(decision.align_id);
  return {};
}

std::vector<const AlignResult*> AlignDesk::standing(std::int64_t now) {
  std::vector<const AlignResult*> out;
  for (Case& one : cases_) {
    if (one.state != State::kDone || one.accepted) continue;
    if (now - one.result.utime > kOpenFor) one.result.open = false;
    if (one.result.open || one.is_offer) out.push_back(&one.result);
  }
  return out;
}

}  // namespace concord
