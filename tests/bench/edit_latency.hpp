#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

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

/// Real ingest and merge with their state in a folder of `state`, a map of about `voxels`, and one person who edits
/// voxel by voxel; round trips and edits take turns. @pre the network is private.
/// @throws std::runtime_error when the stack does not come up or does not answer.
[[nodiscard]] EditLatency measure_edits(std::int64_t voxels, const std::filesystem::path& state);

}  // namespace concord::bench
