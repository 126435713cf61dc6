#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/transform.hpp"

namespace concord::bench {

/// How long things took, microseconds.
struct Latency {
  double p50 = 0;
  double p99 = 0;
};
[[nodiscard]] Latency latency_of(std::vector<double> samples);

struct EditLatency {
  std::int64_t voxels = 0;  ///< known, in the map
  Latency round_trip;       ///< of an equally large message to a process that sends it back, by LCM alone
  Latency edit;             ///< from sending one voxel's edit to hearing the map's change
};

/// What there is when a person edits.
struct EditCase {
  std::int64_t voxels = 0;              ///< of all submaps
  std::vector<Transform> T_map_agents;  ///< one agent each; they all have seen the same
  std::vector<std::string> processes;   ///< of the stack
};

/// The case in real processes, with their state in a folder of `state`, and one person who edits voxel by voxel; round
/// trips and edits take turns. @pre the network is private.
/// @throws std::runtime_error when the stack does not come up or does not answer.
[[nodiscard]] EditLatency measure_edits(const EditCase& given, const std::filesystem::path& state);

struct LabelLatency {
  std::int64_t voxels = 0;          ///< known, in the map
  Latency round_trip;               ///< as above
  Latency label, take_off, remove;  ///< from asking to the answer; `remove` takes the voxels out of the map
};

/// The same for labels of 20 to 40 voxels, after so many instances of so many classes were labelled.
[[nodiscard]] LabelLatency measure_labels(std::int64_t voxels, std::int32_t instances, std::int32_t classes,
                                          const std::filesystem::path& state);

}  // namespace concord::bench
