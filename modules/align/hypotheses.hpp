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
  Support support;
  int iterations = 0;
};

/// Places to look among: those that differ from a transform by no more than this.
struct Vicinity {
  Transform T_target_source = Transform::Identity();
  double yaw = 0.0;    ///< radians
  double reach = 0.0;  ///< metres on each axis along the ground, at the source's origin or at its middle
};
/// Where a person's rough guess may be meant: 2 m on each axis, 45 degrees of yaw, and a margin.
[[nodiscard]] Vicinity around_guess(const Transform& guess);
[[nodiscard]] bool is_in(const Vicinity& vicinity, const Transform& T_target_source,
                         const Eigen::Vector3d& p_source_middle);

/// The places worth judging, best first, each once: from the columns of walls, and the middle of the vicinity itself;
/// with one, none outside of it.
[[nodiscard]] std::vector<Hypothesis> find_hypotheses(const AlignMap& target, const AlignMap& source,
                                                      const std::optional<Vicinity>& vicinity, int threads);

/// Through all levels, coarse to fine, and to the resolution of the source.
[[nodiscard]] GicpResult refine_fully(const AlignMap& target, const AlignMap& source, const Transform& T, int threads);
/// From the finest level on: for what is right to within some voxels.
[[nodiscard]] GicpResult refine_finely(const AlignMap& target, const AlignMap& source, const Transform& T, int threads);

[[nodiscard]] Eigen::Vector3d middle_of(const AlignMap& map);
/// Whether two transforms put the source to places that people would tell apart.
[[nodiscard]] bool are_apart(const Transform& a, const Transform& b, const Eigen::Vector3d& p_source_middle);

}  // namespace concord
