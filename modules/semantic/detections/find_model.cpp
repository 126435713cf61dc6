#include "semantic/detections/find_model.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "semantic/detections/model_evidence.hpp"

namespace concord {
namespace {

/// So that its own axis `up` is the map's z.
Transform upright(const Eigen::Vector3d& up) {
  Transform T = Transform::Identity();
  T.linear() = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

struct Candidate {
  std::uint16_t votes = 0;
  int yaw = 0;
  VoxelIndex at;  ///< the voxel that holds the model's origin
};

/// Votes of one direction, counted cell by cell.
class Ballot {
 public:
  Ballot(const VoxelBox& box, std::int32_t margin) {
    low_ = {box.min.x - margin, box.min.y - margin, box.min.z - margin};
    size_ = {box.max.x - low_.x + 1 + margin, box.max.y - low_.y + 1 + margin, box.max.z - low_.z + 1 + margin};
  }
  [[nodiscard]] std::int64_t cells() const { return std::int64_t{size_.x} * size_.y * size_.z; }
  void clear() { votes_.assign(static_cast<std::size_t>(cells()), 0); }
  void vote(VoxelIndex v) {
    const std::int32_t x = v.x - low_.x, y = v.y - low_.y, z = v.z - low_.z;
    if (x < 0 || y < 0 || z < 0 || x >= size_.x || y >= size_.y || z >= size_.z) return;
    std::uint16_t& count = votes_[(static_cast<std::size_t>(z) * size_.y + y) * size_.x + x];
    if (count < 65535) ++count;
  }
  /// Cells with at least `least` votes.
  template <class Visit>
  void for_each(std::uint16_t least, Visit visit) const {
    std::size_t i = 0;
    for (std::int32_t z = 0; z < size_.z; ++z) {
      for (std::int32_t y = 0; y < size_.y; ++y) {
        for (std::int32_t x = 0; x < size_.x; ++x, ++i) {
          if (votes_[i] >= least) visit(VoxelIndex{low_.x + x, low_.y + y, low_.z + z}, votes_[i]);
        }
      }
    }
  }

 private:
  VoxelIndex low_, size_;
  std::vector<std::uint16_t> votes_;
};

std::vector<Eigen::Vector3d> spread(const std::vector<Eigen::Vector3d>& points, std::size_t most) {
  std::vector<Eigen::Vector3d> out;
  const double step = std::max(1.0, static_cast<double>(points.size()) / static_cast<double>(most));
  for (double i = 0; i < static_cast<double>(points.size()); i += step)
    out.push_back(points[static_cast<std::size_t>(i)]);
  return out;
}

bool is_better(const Candidate& a, const Candidate& b) {
  if (a.votes != b.votes) return a.votes > b.votes;
  return std::tie(a.yaw, a.at) < std::tie(b.yaw, b.at);
}

/// The best, at most kCandidates, no two of one direction within two voxels.
std::vector<Candidate> elected(std::vector<Candidate> all) {
  std::ranges::sort(all, is_better);
  std::vector<Candidate> out;
  for (const Candidate& one : all) {
    const bool is_taken = std::ranges::any_of(out, [&](const Candidate& other) {
      return other.yaw == one.yaw && std::abs(other.at.x - one.at.x) <= 2 && std::abs(other.at.y - one.at.y) <= 2 &&
             std::abs(other.at.z - one.at.z) <= 2;
    });
    if (!is_taken) out.push_back(one);
    if (out.size() == kCandidates) break;
  }
  return out;
}

}  // namespace

Result<std::vector<FoundModel>> find_model(const TriangleMesh& mesh, double scale, const BrickMap& map,
                                           double resolution, const FindOptions& options) {
  const auto p_model = surface_points(mesh, scale, resolution);
  if (!p_model) return tl::unexpected(p_model.error());
  const auto body = model_body(mesh, scale, *p_model, upright(options.up).linear(), resolution);
  if (!body) return tl::unexpected(body.error());
  const SearchedMap searched(map, resolution);
  const auto box = bounds_of(searched.furniture);
  if (!box) return std::vector<FoundModel>();

  double reach = 0;
  for (const Eigen::Vector3d& p : *p_model) reach = std::max(reach, p.norm());
  Ballot ballot(*box, static_cast<std::int32_t>(std::min(reach / resolution + 2, 4000.0)));
  if (ballot.cells() > kMaxFindCells)
    return refuse(Code::kTooLarge, "the map is too wide to be searched; search an agent's part of it");
  const auto voxels = searched.furniture.voxels();
  const auto voters = spread(*p_model, kVoters), few = spread(*p_model, kFitPoints);
  std::vector<Candidate> candidates;
  const auto turned = [&](int yaw) {
    return Transform(Eigen::AngleAxisd(2 * M_PI * yaw / kYaws, Eigen::Vector3d::UnitZ()) * upright(options.up));
  };
  for (int yaw = 0; yaw < kYaws; ++yaw) {
    ballot.clear();
    const Transform T = turned(yaw);
    for (const Eigen::Vector3d& p : voters) {
      const Eigen::Vector3d q = T * p / resolution;
      const VoxelIndex d{static_cast<std::int32_t>(std::lround(q.x())), static_cast<std::int32_t>(std::lround(q.y())),
                         static_cast<std::int32_t>(std::lround(q.z()))};
      for (const VoxelIndex v : voxels) ballot.vote({v.x - d.x, v.y - d.y, v.z - d.z});
    }
    // One that is seen from one side has a quarter of the votes, less those that fall beside.
    ballot.for_each(static_cast<std::uint16_t>(voters.size() / 6 + 1), [&](VoxelIndex at, std::uint16_t votes) {
      candidates.push_back({votes, yaw, at});
    });
  }
  std::vector<FoundModel> found;
  for (const Candidate& one : elected(std::move(candidates))) {
    Transform T = turned(one.yaw);
    T.pretranslate(centre_of(one.at, resolution));
    const ObjectFit fit = fit_object(few, searched.occupied, resolution, T, kNear);
    const FoundModel model = judged(*body, few, searched, fit.T_map_model);
    if (model.score >= options.min_score) found.push_back(model);
  }
  std::ranges::stable_sort(
      found, [](const FoundModel& a, const FoundModel& b) { return a.score * a.matched > b.score * b.matched; });
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : *p_model) middle += p / static_cast<double>(p_model->size());
  std::vector<FoundModel> out;
  for (const FoundModel& one : found) {
    const bool is_taken = std::ranges::any_of(out, [&](const FoundModel& other) {
      return (one.T_map_model * middle - other.T_map_model * middle).norm() < std::max(0.25, reach / 2);
    });
    if (!is_taken && out.size() < static_cast<std::size_t>(std::max(options.most, 0))) out.push_back(one);
  }
  return out;
}

}  // namespace concord
