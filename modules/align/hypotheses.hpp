#pragma once

#include <optional>
#include <vector>

#include "align/align_map.hpp"
#include "align/evidence.hpp"
#include "align/gicp.hpp"

namespace concord {

/// A place for the source, refined as far as telling places apart needs.
struct Hypothesis {
  Transform T_target_source = Transform::Identity();
  double score = 0.0;  ///< see Support
  int iterations = 0;
};

/// The places worth judging, best first, no two the same: from the columns of walls, and the guess itself.
[[nodiscard]] std::vector<Hypothesis> find_hypotheses(const AlignMap& target, const AlignMap& source,
                                                      const std::optional<Transform>& guess, int threads);

/// Those cells of the source that come near the target under `T`, spread evenly, `most` at most.
[[nodiscard]] std::vector<SurfaceCell> cropped(const AlignMap& target, const SurfaceLevel& source, const Transform& T,
                                               std::size_t most);

/// Through all levels, coarse to fine, and to the resolution of the source.
[[nodiscard]] GicpResult refine_fully(const AlignMap& target, const AlignMap& source, const Transform& T, int threads);

}  // namespace concord
