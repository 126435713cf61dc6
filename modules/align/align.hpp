#pragma once

#include <optional>

#include "align/align_map.hpp"
#include "core/alignment.hpp"
#include "core/transform.hpp"

namespace concord {

/// Where the source lies in the target: from a person's rough guess (within 2 m, 45 degrees of yaw), or from none.
/// Both maps are z up to within a few degrees; a guess may say that the source's frame is not.
/// A pure function; the number of threads does not change a bit of it.
/// @pre `guess` is a rigid transform with finite components (see make_transform).
[[nodiscard]] Alignment align(const AlignMap& target, const AlignMap& source, const std::optional<Transform>& guess,
                              int threads);

/// Refines a transform that is right to within some voxels, and judges it: the watch over an aligned agent.
[[nodiscard]] Alignment recheck(const AlignMap& target, const AlignMap& source, const Transform& T_target_source,
                                int threads);

}  // namespace concord
