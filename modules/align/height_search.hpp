#pragma once

#include <vector>

#include "align/align_map.hpp"
#include "core/transform.hpp"

namespace concord {

/// Heights, metres, by which to lift the source so that its levels lie on those of the target, best first, two at most
/// and half a metre apart. `T` places the source from above, between upright frames, with z = 0.
///
/// A histogram of the differences of height of what is level (floors, ceilings, tables) one above the other; of
/// everything, where too little is level. `low` and `high` bound the answer.
[[nodiscard]] std::vector<double> search_heights(const AlignMap& target, const Eigen::Matrix3d& R_upright_target,
                                                 const AlignMap& source, const Eigen::Matrix3d& R_upright_source,
                                                 const Transform& T, double low, double high);

}  // namespace concord
