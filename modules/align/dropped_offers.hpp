#pragma once

#include <optional>
#include <string>
#include <vector>

#include "align/align_task.hpp"

namespace concord {

/// What the watch said and people dropped: it is not said again while it is the same. Pure. Of each agent the last
/// correction and the last contradiction are kept, until it is placed anew or begins another frame.
class DroppedOffers {
 public:
  static constexpr std::size_t kMaxKept = 256;  ///< the oldest are forgotten
  /// So much more of the walls must speak against a place than when its contradiction was dropped.
  static constexpr double kMoreAgainst = 0.05;

  /// `place`: where the agent lay when it was found.
  void add(const std::string& id, const Place& place, const Alignment& said);
  /// Whether the offer of this id was dropped.
  [[nodiscard]] bool contains(const std::string& id) const;
  /// Whether people have dropped as good as this of the task's agent where it lies: a correction that differs by no
  /// more than what counts as a slip (Slip::is_large), or a contradiction in hardly more walls.
  /// @pre a recheck.
  [[nodiscard]] bool covers(const AlignTask& task, const Alignment& said) const;
  /// Forgets what was dropped of agents that lie elsewhere now.
  void heed(const AgentLayers& layers);

 private:
  struct Dropped {
    std::string id;
    Place place;
    bool is_correction = false;
    Transform T_map_agent = Transform::Identity();  ///< of a correction
    double against = 0.0;                           ///< share of the walls, of a contradiction
  };
  std::vector<Dropped> dropped_;  ///< the oldest first
};

}  // namespace concord
