#include "semantic/detections/model_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "semantic/models/solid_voxels.hpp"
#include "semantic/segmentation/room_planes.hpp"

namespace concord {
namespace {

/// A scanner looks down at things by so much, radians; from so many sides.
constexpr double kLookDown = 0.4;
constexpr int kSides = 8;
/// Voxels behind what is seen first that are seen, too: steps of a slanted face.
constexpr double kStep = 1.5;

/// The share of the points that nothing hides from one side.
double shown(const std::vector<Eigen::Vector3d>& p_model, const Eigen::Matrix3d& R_look_model, double resolution) {
  std::map<std::pair<int, int>, double> first;  // depth, by pixels of a voxel's width
  const auto pixel_of = [&](const Eigen::Vector3d& p) {
    return std::pair(static_cast<int>(std::floor(p.y() / resolution)),
                     static_cast<int>(std::floor(p.z() / resolution)));
  };
  for (const Eigen::Vector3d& p : p_model) {
    const Eigen::Vector3d p_look = R_look_model * p;
    const auto [it, is_new] = first.try_emplace(pixel_of(p_look), p_look.x());
    it->second = std::min(it->second, p_look.x());
  }
  const auto count = std::ranges::count_if(p_model, [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d p_look = R_look_model * p;
    return p_look.x() <= first[pixel_of(p_look)] + kStep * resolution;
  });
  return static_cast<double>(count) / static_cast<double>(p_model.size());
}

BrickMasks with_faces(const BrickMasks& voxels) {
  BrickMasks out;
  for (const VoxelIndex v : voxels.voxels()) {
    for (int d = -1; d <= 1; ++d) {
      out.insert({v.x + d, v.y, v.z});
      out.insert({v.x, v.y + d, v.z});
      out.insert({v.x, v.y, v.z + d});
    }
  }
  return out;
}

bool is_free_at(const BrickMap& map, VoxelIndex v) { return in_bounds(v) && is_free(map.at(v)); }

/// Whether this holds for all voxels within `reach` of one along each axis.
template <class Test>
bool all_within(VoxelIndex v, int reach, Test test) {
  for (int z = -reach; z <= reach; ++z) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        if (!test(VoxelIndex{v.x + x, v.y + y, v.z + z})) return false;
      }
    }
  }
  return true;
}

/// Nearer than a fit asks for: a box is within a voxel and a half of many things.
bool is_at(const BrickMasks& furniture, VoxelIndex v) {
  return furniture.contains(v) || furniture.contains({v.x - 1, v.y, v.z}) || furniture.contains({v.x + 1, v.y, v.z}) ||
         furniture.contains({v.x, v.y - 1, v.z}) || furniture.contains({v.x, v.y + 1, v.z}) ||
         furniture.contains({v.x, v.y, v.z - 1}) || furniture.contains({v.x, v.y, v.z + 1});
}

/// Nobody has seen it: it was filled, as injected models are, and in its number would outvote all that was seen.
bool is_inside(const BrickMasks& occupied, VoxelIndex v) {
  return occupied.contains({v.x - 1, v.y, v.z}) && occupied.contains({v.x + 1, v.y, v.z}) &&
         occupied.contains({v.x, v.y - 1, v.z}) && occupied.contains({v.x, v.y + 1, v.z}) &&
         occupied.contains({v.x, v.y, v.z - 1}) && occupied.contains({v.x, v.y, v.z + 1});
}

/// A box about as large as a pump has its corners where the pump has nothing.
double explained(const ModelBody& body, const SearchedMap& searched, const Transform& T_map_model) {
  const double resolution = searched.resolution;
  const Eigen::AlignedBox3d box = body.box.transformed(Eigen::Affine3d(T_map_model.matrix()));
  const VoxelIndex low = voxel_of(box.min(), resolution), high = voxel_of(box.max(), resolution);
  const Transform T_model_map = T_map_model.inverse();
  std::size_t mine = 0, others = 0;
  for (std::int32_t z = low.z; z <= high.z; ++z) {
    for (std::int32_t y = low.y; y <= high.y; ++y) {
      for (std::int32_t x = low.x; x <= high.x; ++x) {
        if (!searched.furniture.contains({x, y, z})) continue;
        const Eigen::Vector3d p = T_model_map * centre_of({x, y, z}, resolution);
        if (!body.box.contains(p)) continue;
        const VoxelIndex v = voxel_of(p, resolution);
        if (body.own.contains(v)) {
          ++mine;
        } else if (!body.beside.contains(v)) {
          ++others;
        }
      }
    }
  }
  return mine > 0 ? static_cast<double>(mine) / static_cast<double>(mine + others) : 0.0;
}

}  // namespace

Result<ModelBody> model_body(const TriangleMesh& mesh, double scale, const std::vector<Eigen::Vector3d>& p_model,
                             const Eigen::Matrix3d& R_upright_model, double resolution) {
  const auto filled = voxelize(mesh, {Transform::Identity(), scale}, resolution, Fill::kSolid);
  if (!filled) return tl::unexpected(filled.error());
  ModelBody body;
  BrickMasks all = filled->surface;
  all.insert(filled->interior);
  body.own = with_faces(all);
  body.beside = with_faces(body.own);
  for (const Eigen::Vector3d& p : p_model) body.box.extend(p);
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kBeyond * resolution);
  body.box = {body.box.min() - margin, body.box.max() + margin};
  const Eigen::AngleAxisd down(-kLookDown, Eigen::Vector3d::UnitY());
  for (int side = 0; side < kSides; ++side) {
    const Eigen::AngleAxisd turn(2 * M_PI * side / kSides, Eigen::Vector3d::UnitZ());
    body.most_shown = std::max(body.most_shown, shown(p_model, (down * turn) * R_upright_model, resolution));
  }
  return body;
}

SearchedMap::SearchedMap(const BrickMap& of, double metres)
    : map(of), resolution(metres), occupied(occupied_of(of)), furniture(occupied) {
  const RoomPlanes room = find_room_planes(occupied, resolution);
  furniture.erase(room.voxels);
  // A floor is scanned two voxels thick; taken for furniture it would be a seat to every chair sunk into it.
  BrickMasks none;
  for (const VoxelIndex v : furniture.voxels()) {
    if ((room.floor_z && v.z <= *room.floor_z + 1) || is_inside(occupied, v)) none.insert(v);
  }
  furniture.erase(none);
  map.for_each_brick([&](BrickIndex, const Brick& brick) {
    if (has_free) return;
    DenseBrick dense;
    brick.to_dense(dense);
    has_free = std::ranges::any_of(dense, [](LogOdds value) { return is_free(value); });
  });
}

FoundModel judged(const ModelBody& body, const std::vector<Eigen::Vector3d>& p_model, const SearchedMap& searched,
                  const Transform& T_map_model) {
  std::size_t matched = 0, free = 0, seen = 0;
  const auto is_free_here = [&](VoxelIndex v) { return is_free_at(searched.map, v); };
  const auto is_not_free = [&](VoxelIndex v) { return !is_free_at(searched.map, v); };
  for (const Eigen::Vector3d& p : p_model) {
    const VoxelIndex v = voxel_of(T_map_model * p, searched.resolution);
    const bool is_matched = is_at(searched.furniture, v);
    matched += is_matched ? 1 : 0;
    free += all_within(v, 1, is_free_here) ? 1 : 0;
    seen += is_matched || !searched.has_free || !all_within(v, kNearFree, is_not_free) ? 1 : 0;
  }
  const auto share = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(p_model.size());
  };
  FoundModel out{T_map_model, 0, share(matched), share(free), share(seen), explained(body, searched, T_map_model)};
  if (matched == 0) return out;
  const double of_seen = std::min(1.0, out.matched / (kEnoughMatched * out.seen));
  const double of_shown = std::min(1.0, out.matched / (kEnoughShown * body.most_shown));
  const double not_free = out.matched / (out.matched + kFreeWeight * out.free);
  out.score = of_seen * of_shown * not_free * not_free * std::pow(out.explained, 4);
  return out;
}

}  // namespace concord
