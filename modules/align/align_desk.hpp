#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "align/align_task.hpp"
#include "align/dropped_offers.hpp"
#include "align/map_founding.hpp"
#include "core/alignment.hpp"
#include "core/error.hpp"

namespace concord {

/// What was asked and found: requests wait in a queue, and what came of them is kept until people decide. Pure: it is
/// given the time, and nothing here moves an agent.
class AlignDesk {
 public:
  static constexpr std::size_t kMaxWaiting = 16;
  static constexpr std::size_t kMaxKept = 64;            ///< of what was found; the oldest are forgotten
  static constexpr std::int64_t kOpenFor = 600'000'000;  ///< microseconds in which it can be accepted

  struct Case {
    enum class State { kWaiting, kRunning, kDone, kDropped };
    AlignRequest request;  ///< of an offer only its id and source
    std::uint64_t content = 0;
    State state = State::kWaiting;
    AlignResult result;
    std::vector<Place> places;              ///< that it was found from; empty: the target is an agent
    std::optional<TransformRequest> asked;  ///< of merge, by the last decision
    bool accepted = false;                  ///< merge did what was asked
    bool is_offer = false;
  };

  /// How a request of this id stands; null: it is new. Refused (kExists): another one has this id.
  [[nodiscard]] Result<const Case*> find(const std::string& id, std::uint64_t content) const;
  /// How many are before it. @pre it waits.
  [[nodiscard]] std::size_t ahead_of(const std::string& id) const;
  /// Refused (kBusy): too many wait. @pre find says that it is new.
  [[nodiscard]] Result<void> take(AlignRequest request, std::uint64_t content);

  /// The next request to carry out, which runs from now on; null: none waits, or one runs.
  [[nodiscard]] const AlignRequest* begin_next();
  /// What came of the one that runs. Null: it was dropped meanwhile.
  const AlignResult* finish(const AlignTask& task, AlignResult result);
  /// The one that runs cannot be carried out, and is forgotten. False: it was dropped meanwhile.
  bool give_up(const std::string& id);

  /// The watch found that an agent slipped, or contradicts the others: takes the place of what it said before. Null:
  /// people have dropped as good as that (see DroppedOffers), and nothing is said of the agent.
  const AlignResult* offer(const AlignTask& task, AlignResult result);
  /// The agent lies right.
  void withdraw_offer(const std::string& agent);
  /// Withdraws what is said of agents that lie elsewhere now, or among others that do; and takes what shows in the map
  /// for accepted, though merge's answer was lost.
  void heed(const AgentLayers& layers);
  /// Withdraws what has been said for too long. @return of which agents.
  std::vector<std::string> expire_offers(std::int64_t now);
  [[nodiscard]] bool has_offer(const std::string& agent) const;

  /// Where accepting places an agent: the source or, where nobody is in the map yet, first the target that founds it;
  /// `is_founding` says which. Asked again by the same decision it is the same; it is accepted once merge has agreed,
  /// until then another decision takes its place. `is_founded`: somebody is in the map.
  /// Refused: nothing of that id is kept, or it is too old (kExpired); it waits or runs (kBusy); it was refused
  /// (kBadRequest) or accepted by another decision (kConflict); a frame has ended (kBadFrame); the map has moved since
  /// (kStale); the target is in no map (kNotAligned), or another one is about to found it (kBusy).
  struct Acceptance {
    TransformRequest request;
    bool is_founding = false;
  };
  [[nodiscard]] Result<Acceptance> accept(const AlignDecision& decision, const AgentLayers& layers, bool is_founded,
                                          std::int64_t now);
  /// The pair that is about to found the map: to be kept over a restart, before merge is asked.
  [[nodiscard]] const std::optional<MapFounding>& founding() const { return founding_; }
  /// As it was kept. @pre none is under way.
  void resume(MapFounding founding);
  /// What merge is to be asked next, to bring it to an end; kOver: nothing, and it is forgotten.
  [[nodiscard]] FoundingStep go_on_founding(const AgentLayers& layers, bool is_founded, std::int64_t now);
  /// What merge said to what it was asked by this id.
  void on_merge(const std::string& id, bool ok);
  /// Again by whoever has not heard of it. Refused (kExpired): nothing of that id is kept; (kConflict): it was
  /// accepted.
  [[nodiscard]] Result<void> drop(const AlignDecision& decision);

  /// What people should know now: what can be accepted, and what the watch says. The oldest first.
  [[nodiscard]] std::vector<const AlignResult*> standing(const AgentLayers& layers, std::int64_t now);
  [[nodiscard]] std::size_t waiting() const;
  [[nodiscard]] std::size_t offers() const;

 private:
  [[nodiscard]] Case* find(const std::string& id);
  [[nodiscard]] Result<Transform> T_map_target(const Case& found, const AgentLayers& layers) const;
  [[nodiscard]] bool may_hold(const Case& found, const AgentLayers& layers) const;
  [[nodiscard]] static Result<TransformRequest> placement(const Case& found, const AlignDecision& decision,
                                                          const Transform& T_map_target);
  void hear_founding(const std::string& id, bool ok);
  [[nodiscard]] Result<Acceptance> found_map(Case& found, const AlignDecision& decision);
  void forget_the_oldest();

  std::optional<MapFounding> founding_;
  DroppedOffers dropped_;
  std::deque<Case> cases_;  ///< in the order in which they were asked
};

}  // namespace concord
