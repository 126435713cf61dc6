#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "align/align_task.hpp"
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
    enum class State { kWaiting, kRunning, kDone };
    AlignRequest request;  ///< of an offer only its id and source
    std::uint64_t content = 0;
    State state = State::kWaiting;
    AlignResult result;
    /// Where those lay that made up the map; empty: the target is an agent.
    std::vector<std::pair<std::string, Transform>> placed;
    std::optional<TransformRequest> accepted;
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
  /// The one that runs cannot be carried out, and is forgotten.
  void give_up(const std::string& id);

  /// The watch found that an agent slipped, or contradicts the others: takes the place of what it said before.
  const AlignResult& offer(const AlignTask& task, AlignResult result);
  /// The agent lies right, or is no longer there.
  void withdraw_offer(const std::string& agent);
  [[nodiscard]] bool has_offer(const std::string& agent) const;

  /// Where accepting places an agent: the source or, where nobody is in the map yet, first the target that founds it;
  /// `is_founding` says which. Asked again by the same decision it is the same.
  /// Refused: nothing of that id is kept, or it is too old (kExpired); it waits or runs (kBusy); it was refused
  /// (kBadRequest) or accepted by another decision (kConflict); a frame has ended (kBadFrame); the map has moved since
  /// (kStale); the target is in no map (kNotAligned).
  struct Acceptance {
    TransformRequest request;
    bool is_founding = false;
  };
  [[nodiscard]] Result<Acceptance> accept(const AlignDecision& decision, const AgentLayers& layers, std::int64_t now);
  /// Refused (kExpired): nothing of that id is kept; (kConflict): it was accepted.
  [[nodiscard]] Result<void> drop(const AlignDecision& decision);

  /// What people should know now: what can be accepted, and what the watch says. The oldest first.
  [[nodiscard]] std::vector<const AlignResult*> standing(std::int64_t now);
  [[nodiscard]] std::size_t waiting() const;
  [[nodiscard]] std::size_t offers() const;

 private:
  [[nodiscard]] Case* find(const std::string& id);
  [[nodiscard]] Result<Transform> T_map_target(const Case& found, const AgentLayers& layers) const;
  void forget_the_oldest();

  std::deque<Case> cases_;  ///< in the order in which they were asked
};

}  // namespace concord
