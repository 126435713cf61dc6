#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "align/align.hpp"
#include "core/agent_layer.hpp"
#include "core/alignment.hpp"
#include "core/brick_map.hpp"
#include "core/error.hpp"
#include "core/policy.hpp"

namespace concord {

/// Where an agent lay in the map.
struct Place {
  std::string agent;
  std::string frame_id;
  Transform T_map_agent = Transform::Identity();
};
/// Of all who are aligned, by agent.
[[nodiscard]] std::vector<Place> places_of(const AgentLayers& layers);
/// Whether it lies there still.
[[nodiscard]] bool lies_at(const Place& place, const AgentLayers& layers);

/// What the map's lattice and policy are.
struct AlignSite {
  double resolution = 0.05;
  Policy policy = Policy::kMean;
};

/// All that an alignment is computed from: a copy, so that the layers may go on changing.
struct AlignTask {
  struct Part {
    std::string agent;
    BrickMap map;
    Transform T_target_part = Transform::Identity();
    int weight = 1;
  };
  std::string id;
  AlignSite site;
  BrickMap source;
  std::vector<Part> target;  ///< by agent; merged, where there are several
  std::optional<Transform> T_target_source;
  Eigen::Vector3d p_source_middle = Eigen::Vector3d::Zero();
  bool is_recheck = false;  ///< the transform is right to within some voxels, or no longer holds
  /// As told in the result.
  AlignResult::Used used_source;
  std::string target_agent;  ///< empty: the map
  std::vector<AlignResult::Used> used_layers;
};

/// The task that a request asks for; `check_task` says at no cost whether there is one. The map as a target is what the
/// other aligned agents make: an agent that is in it already would agree with itself. Refused: no such agent, or one
/// without a submap (kNoAgent); in another frame now (kBadFrame); not whole yet (kBusy); itself (kBadRequest); nobody
/// else is in the map (kNoMap).
[[nodiscard]] Result<void> check_task(const AlignRequest& request, const AgentLayers& layers);
[[nodiscard]] Result<AlignTask> make_task(const AlignRequest& request, const AgentLayers& layers,
                                          const AlignSite& site);

/// Where those lay that the task took to be there: who makes up the map and, of a recheck, the agent itself; empty
/// where the target is an agent, wherever that lies.
[[nodiscard]] std::vector<Place> places_of(const AlignTask& task);

/// Whether an aligned agent lies right among the others: only what lies within `kRecheckMargin` of both is copied.
/// Refused: as above, and kNotAligned.
[[nodiscard]] Result<AlignTask> make_recheck(const std::string& agent, const AgentLayers& layers,
                                             const AlignSite& site);
inline constexpr double kRecheckMargin = 2.0;  // metres
/// Whether the others speak against where an agent lies beyond what a place that is right has against it: DIVERGED, and
/// a twentieth of the walls or a seventh of the floors. Below that noise and furniture explain it as well.
[[nodiscard]] bool contradicts(const Alignment& alignment);

/// A pure function of the task; `threads` does not change a bit of it. What is looked at again and does not lie where
/// it was put (DIVERGED) is looked for as from a rough guess: it may have slipped farther than a recheck reaches.
/// Refused: see prepare_map; a stop was asked for (kExpired).
[[nodiscard]] Result<Alignment> carry_out(const AlignTask& task, int threads, std::stop_token stop = {});

/// What was found with what it was found from, as it is told.
[[nodiscard]] AlignResult result_of(const AlignTask& task, Alignment alignment, std::int64_t utime);

}  // namespace concord
