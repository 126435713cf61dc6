#pragma once

#include <string>
#include <vector>

#include "align/align_map.hpp"
#include "align/gicp.hpp"
#include "core/transform.hpp"

namespace concord {

/// What one map says of the surface of the other, square metres. Only flat pieces are asked: what is no plane is noise
/// as often as not.
struct Verdicts {
  double all = 0.0;           ///< of the surface asked
  double matched = 0.0;       ///< lies on a surface that faces the same way
  double contradicted = 0.0;  ///< lies where the other saw that nothing is
  void add(const Verdicts& other) {
    all += other.all;
    matched += other.matched;
    contradicted += other.contradicted;
  }
  [[nodiscard]] double overlap() const { return all > 0.0 ? matched / all : 0.0; }
  [[nodiscard]] double contradiction() const {
    return matched + contradicted > 0.0 ? contradicted / (matched + contradicted) : 0.0;
  }
};

/// Both ways. Walls and furniture apart from floors and ceilings, which lie on each other wherever the maps are put.
struct Support {
  Verdicts source_upright, source_level;  ///< the source's surface, judged by the target
  Verdicts target_upright, target_level;
  [[nodiscard]] Verdicts upright() const {
    Verdicts v = source_upright;
    v.add(target_upright);
    return v;
  }
  [[nodiscard]] Verdicts level() const {
    Verdicts v = source_level;
    v.add(target_level);
    return v;
  }
  [[nodiscard]] double overlap_source() const;
  [[nodiscard]] double overlap_target() const;
  /// What speaks for a place less what speaks against it, square metres of upright surface, mean of both ways.
  [[nodiscard]] double score() const;
};

/// `pieces`: how many of each map are asked, spread evenly.
[[nodiscard]] Support support(const AlignMap& target, const AlignMap& source, const Transform& T_target_source,
                              std::size_t pieces, int threads);

/// A direction that the surfaces do not hold.
struct LooseDirection {
  Eigen::Vector3d axis;  ///< target's frame, unit length
  bool is_turn = false;  ///< about the axis; else along it
  std::string words;     ///< e.g. "slides along x", "turns about z"
};

/// From the Hessian: the share of the pairs' weight that measures a direction is below what noise of normals gives.
[[nodiscard]] std::vector<LooseDirection> loose_directions(const GicpResult& result);

/// 6 x 6, rotation about `p_target_centre` then translation, target's axes; of the noise across the surfaces, with
/// neighbouring cells counted as one measurement.
[[nodiscard]] Matrix6 covariance(const GicpResult& result);

/// "slides along x (0.98 0.17 0.00)"
[[nodiscard]] std::string name_slide(const Eigen::Vector3d& axis);

}  // namespace concord
