#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "align/align_task.hpp"

namespace concord {

/// Whom to look at next, so that everybody who keeps mapping is looked at now and then at a bounded cost. Pure: it is
/// given the time.
class DriftWatch {
 public:
  static constexpr std::int64_t kLeastPause = 5'000'000;  ///< microseconds between two looks
  /// Of one processor: a look that took t is followed by a pause of 19 t.
  static constexpr double kShare = 0.05;

  /// The aligned agent that was looked at the longest ago, of those that sent something since or were moved; none: not
  /// now.
  [[nodiscard]] std::optional<std::string> next(const AgentLayers& layers, std::int64_t now) const;
  /// It was looked at as it is in `layers`, which took so many microseconds.
  void looked_at(const std::string& agent, const AgentLayers& layers, std::int64_t took, std::int64_t now);

 private:
  struct Seen {
    std::string frame_id;
    std::int64_t revision = 0;
    Transform T_map_agent = Transform::Identity();
    std::int64_t when = 0;
  };
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
