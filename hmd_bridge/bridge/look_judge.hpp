#pragma once

#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "bus/bus.hpp"
#include "mapper/look.hpp"

namespace concord::hmd {

/// Judges looks beside the loop, one at a time, in the order in which they came: one may take most of a second.
class LookJudge {
 public:
  static constexpr std::size_t kMostOfOne = 2;          ///< looks of one agent that wait
  static constexpr std::size_t kMostBytes = 64 << 20;   ///< of all that wait
  static constexpr std::size_t kBricksOfATurn = 2'000;  ///< that are handed over at once

  struct Look {
    std::string agent;
    std::shared_ptr<RoomMapper> mapper;  ///< nobody else touches it while a look of it waits
    bool anew = false;                   ///< sequences begin anew with it
    PackedFrame frame;
    /// What changed, in turns; then the outcome.
    std::function<void(BrickIndex, Brick)> on_brick;
    std::function<void(const Judged&)> on_end;
    /// Asked when its turn has come: a refusal is what comes of it.
    std::function<Result<void>()> has_room = [] { return Result<void>(); };
  };

  /// @param how async; or deferred, where time stands still.
  LookJudge(Bus& bus, std::launch how);
  LookJudge(const LookJudge&) = delete;
  LookJudge& operator=(const LookJudge&) = delete;

  /// False: too much waits; nothing was taken.
  [[nodiscard]] bool offer(Look look);

 private:
  void step();
  void begin();
  void hand_over();

  std::launch how_;
  std::deque<Look> waiting_;  ///< the first is the one under way
  std::size_t bytes_ = 0;
  std::future<Judged> running_;
  std::optional<Judged> judged_;
  std::size_t handed_ = 0;
};

}  // namespace concord::hmd
