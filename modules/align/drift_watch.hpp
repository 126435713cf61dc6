#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "align/align_task.hpp"

namespace concord {

/// Whom to look at next, so that everybody who keeps mapping is looked at now and then at a bounded cost. Pure: it is
/// given the time.
class DriftWatch {
 public:
  static constexpr std::int64_t kLeastPause = 5'000'000;  ///< microseconds between two looks
  /// Of one processor: a look that took t is followed by a pause of 19 t.
  static constexpr double kShare = 0.05;

  /// An agent as it was when it began to be looked at, and where everybody lay.
  struct Look {
    std::string agent;
    std::int64_t revision = 0;
    std::vector<Place> places;
  };

  /// The aligned agent that was looked at the longest ago, of those that sent something since, or that lie otherwise
  /// among the others: they or it were moved. None: not now.
  [[nodiscard]] std::optional<std::string> next(const AgentLayers& layers, std::int64_t now) const;
  /// @pre the agent is among the layers.
  [[nodiscard]] static Look begin(const std::string& agent, const AgentLayers& layers);
  /// That look is over, and took so many microseconds.
  void looked_at(Look look, std::int64_t took, std::int64_t now);
  /// What was found of it holds no longer: it is looked at again.
  void forget(const std::string& agent);

 private:
  struct Seen {
    Look look;
    std::int64_t when = 0;
  };
  [[nodiscard]] static bool is_as_it_was(const Look& look, const AgentLayers& layers);

  std::map<std::string, Seen> seen_;
  std::int64_t not_before_ = 0;
};

/// How far a found place is from where the agent lies.
struct Slip {
  double metres = 0.0;  ///< at `p_agent`
  double radians = 0.0;

  /// Beyond what alignment itself may be off by: people should know.
  [[nodiscard]] bool is_large(double resolution) const;
};
[[nodiscard]] Slip slip_between(const Transform& T_map_agent, const Transform& found, const Eigen::Vector3d& p_agent);

}  // namespace concord
