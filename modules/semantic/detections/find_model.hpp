#pragma once

#include <vector>

#include "core/brick_map.hpp"
#include "core/transform.hpp"
#include "semantic/detections/model_evidence.hpp"
#include "semantic/detections/object_fit.hpp"

namespace concord {

struct FindOptions {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< of the model's own axes: it is sought upright
  double min_score = 0.75;
  int most = 20;
};

/// Finds a known model in the occupied surface of a map that is z up, wherever it stands and whichever way it is
/// turned.
///
/// For kYaws directions each occupied voxel that is not floor, ceiling or wall (find_room_planes) votes for the places
/// of the model of which it could be a part of (a Hough transform: kVoters points spread over the model's surface). The
/// kCandidates places with the most votes are fitted (fit_object, within kNear), judged, and of those that overlap the
/// best is kept. By descending score, then place. Refused: as by surface_points; a map of over kMaxFindCells cells of a
/// box (kTooLarge).
[[nodiscard]] Result<std::vector<FoundModel>> find_model(const TriangleMesh& mesh, double scale, const BrickMap& map,
                                                         double resolution, const FindOptions& options = {});

inline constexpr int kYaws = 24;
inline constexpr std::size_t kVoters = 150;
inline constexpr std::size_t kCandidates = 120;
inline constexpr std::int64_t kMaxFindCells = 150'000'000;
inline constexpr double kNear = 0.2;  ///< metres: half of what one direction is from the next, at the end of a metre
inline constexpr std::size_t kFitPoints = 500;

}  // namespace concord
