#pragma once

#include <utility>
#include <vector>

#include "align/align_map.hpp"
#include "align/gicp.hpp"
#include "core/transform.hpp"

namespace concord {

/// What one map says of the surface of the other, square metres. Flat pieces are asked, and solid ones, which
/// count as upright; what is neither is noise as often as not.
struct Verdicts {
  double all = 0.0;           ///< of the surface asked
  double matched = 0.0;       ///< lies on a surface that faces the same way
  double displaced = 0.0;     ///< hugs a surface but does not lie on it, or faces another way
  double contradicted = 0.0;  ///< lies where the other saw that nothing is
  void add(const Verdicts& other);
  [[nodiscard]] double against() const { return displaced + contradicted; }
  /// Of what the other can say anything about.
  [[nodiscard]] double share_against() const {
    return matched + against() > 0.0 ? against() / (matched + against()) : 0.0;
  }
};

/// Both ways. Walls and furniture apart from floors and ceilings, which lie on each other wherever the maps are put.
struct Support {
  Verdicts source_upright, source_level;  ///< the source's surface, judged by the target
  Verdicts target_upright, target_level;
  /// Sums over upright pieces, both ways, of area times n n^T with the horizontal normal n in the target's frame: how
  /// much of what is matched, and of what speaks against, faces each direction.
  Eigen::Matrix2d matched_facing = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d against_facing = Eigen::Matrix2d::Zero();

  [[nodiscard]] Verdicts upright() const;
  [[nodiscard]] Verdicts level() const;
  [[nodiscard]] Verdicts all() const;
  [[nodiscard]] double overlap_source() const;
  [[nodiscard]] double overlap_target() const;
  /// Square metres of walls and furniture that lie right, less ten times those that speak against: zero where one in
  /// eleven does. By it places are ranked.
  [[nodiscard]] double score() const;
  /// Whether in some direction more than a fifth of what faces it speaks against, beyond a hundredth of everything.
  [[nodiscard]] bool is_contested() const;
  /// The direction along the ground that the fewest walls face.
  [[nodiscard]] Eigen::Vector2d weak_direction() const;
};

/// A piece of a wall or of furniture that speaks against.
struct PieceAgainst {
  Eigen::Vector3d p_target;
  Eigen::Matrix2d facing;  ///< its part of Support::against_facing
  double area = 0.0;       ///< square metres
  bool is_displaced = false;
  bool is_of_source = false;
};

/// `pieces`: how many of each map are asked, spread evenly.
[[nodiscard]] Support support(const AlignMap& target, const AlignMap& source, const Transform& T_target_source,
                              std::size_t pieces, int threads);

/// What in support(...) of the same arguments is against, upright, piece by piece.
[[nodiscard]] std::vector<PieceAgainst> pieces_against(const AlignMap& target, const AlignMap& source,
                                                       const Transform& T_target_source, std::size_t pieces);

/// 6 x 6, rotation about `p_target_centre` then translation, target's axes; of the noise across the surfaces, with
/// neighbouring cells counted as one measurement.
[[nodiscard]] Matrix6 covariance(const GicpResult& result);

}  // namespace concord
