#include "semantic/find_model.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "semantic/room_planes.hpp"
#include "semantic/solid_voxels.hpp"

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

/// Of the model's surface, what lies in an occupied voxel or at the face of one, and what lies amidst free ones. Nearer
/// than a fit asks for: a box is within a voxel and a half of many things.
FoundModel judged(const std::vector<Eigen::Vector3d>& p_model, const BrickMap& map, double resolution,
                  const Transform& T) {
  std::size_t matched = 0, free = 0;
  for (const Eigen::Vector3d& p : p_model) {
    const VoxelIndex v = voxel_of(T * p, resolution);
    bool is_matched = false, is_amidst_free = true;
    for (int i = 0; i < 27; ++i) {
      const VoxelIndex d{i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1}, beside{v.x + d.x, v.y + d.y, v.z + d.z};
      const LogOdds value = in_bounds(beside) ? map.at(beside) : kUnknown;
      is_amidst_free = is_amidst_free && is_free(value);
      const bool is_at_face = std::abs(d.x) + std::abs(d.y) + std::abs(d.z) <= 1;
      is_matched = is_matched || (is_at_face && is_known(value) && is_occupied(value));
    }
    matched += is_matched ? 1 : 0;
    free += is_amidst_free ? 1 : 0;
  }
  const auto share = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(p_model.size());
  };
  FoundModel out{T, 0, share(matched), share(free)};
  const double seen = out.matched + out.free;
  if (seen > 0) out.score = out.matched / seen * std::min(1.0, out.matched / kEnoughSeen);
  return out;
}

/// What a model takes up, for the question whether things that are seen belong to it.
struct ModelBody {
  Eigen::AlignedBox3d box;  ///< metres, model's axes, with a margin of kBeyond voxels
  BrickMasks near;          ///< voxels of the model's own lattice that are in it or at the face of one that is
};

Result<ModelBody> body_of(const TriangleMesh& mesh, double scale, const std::vector<Eigen::Vector3d>& p_model,
                          double resolution) {
  const auto filled = voxelize(mesh, {Transform::Identity(), scale}, resolution, Fill::kSolid);
  if (!filled) return tl::unexpected(filled.error());
  ModelBody body;
  BrickMasks all = filled->surface;
  all.insert(filled->interior);
  for (const VoxelIndex v : all.voxels()) {
    for (int d = -1; d <= 1; ++d) {
      body.near.insert({v.x + d, v.y, v.z});
      body.near.insert({v.x, v.y + d, v.z});
      body.near.insert({v.x, v.y, v.z + d});
    }
  }
  for (const Eigen::Vector3d& p : p_model) body.box.extend(p);
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kBeyond * resolution);
  body.box = {body.box.min() - margin, body.box.max() + margin};
  return body;
}

/// Of the furniture around a placed model, the share that is it: a box about as large as a pump has its corners where
/// the pump has nothing.
double explained(const ModelBody& body, const BrickMasks& furniture, double resolution, const Transform& T_map_model) {
  const Eigen::AlignedBox3d box = body.box.transformed(Eigen::Affine3d(T_map_model.matrix()));
  const VoxelIndex low = voxel_of(box.min(), resolution), high = voxel_of(box.max(), resolution);
  const Transform T_model_map = T_map_model.inverse();
  std::size_t mine = 0, others = 0;
  for (std::int32_t z = low.z; z <= high.z; ++z) {
    for (std::int32_t y = low.y; y <= high.y; ++y) {
      for (std::int32_t x = low.x; x <= high.x; ++x) {
        if (!furniture.contains({x, y, z})) continue;
        const Eigen::Vector3d p = T_model_map * centre_of({x, y, z}, resolution);
        if (!body.box.contains(p)) continue;
        ++(body.near.contains(voxel_of(p, resolution)) ? mine : others);
      }
    }
  }
  return mine > 0 ? static_cast<double>(mine) / static_cast<double>(mine + others) : 0.0;
}

}  // namespace

Result<std::vector<FoundModel>> find_model(const TriangleMesh& mesh, double scale, const BrickMap& map,
                                           double resolution, const FindOptions& options) {
  const auto p_model = surface_points(mesh, scale, resolution);
  if (!p_model) return tl::unexpected(p_model.error());
  const auto body = body_of(mesh, scale, *p_model, resolution);
  if (!body) return tl::unexpected(body.error());
  const BrickMasks occupied = occupied_of(map);
  BrickMasks furniture = occupied;
  furniture.erase(find_room_planes(occupied, resolution).voxels);
  const auto box = bounds_of(furniture);
  if (!box) return std::vector<FoundModel>();

  double reach = 0;
  for (const Eigen::Vector3d& p : *p_model) reach = std::max(reach, p.norm());
  Ballot ballot(*box, static_cast<std::int32_t>(std::min(reach / resolution + 2, 4000.0)));
  if (ballot.cells() > kMaxFindCells)
    return refuse(Code::kTooLarge, "the map is too wide to be searched; search an agent's part of it");
  const auto voxels = furniture.voxels();
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
    // One that is seen from one side at all has a quarter of the votes.
    ballot.for_each(static_cast<std::uint16_t>(voters.size() / 4 + 1), [&](VoxelIndex at, std::uint16_t votes) {
      candidates.push_back({votes, yaw, at});
    });
  }
  std::vector<FoundModel> found;
  for (const Candidate& one : elected(std::move(candidates))) {
    Transform T = turned(one.yaw);
    T.pretranslate(centre_of(one.at, resolution));
    FoundModel model = judged(few, map, resolution, fit_object(few, occupied, resolution, T, kNear).T_map_model);
    model.explained = explained(*body, furniture, resolution, model.T_map_model);
    model.score *= model.explained * model.explained;
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
