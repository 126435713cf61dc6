#include "semantic/segmentation/upright_face.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>

#include <pcl/ModelCoefficients.h>
#include <pcl/console/print.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/sac_segmentation.h>

#include "semantic/segmentation/cell_rectangle.hpp"

namespace concord {
namespace {

constexpr double kAround = 0.2;       ///< metres: where the plane is looked for first
constexpr double kLeastArea = 0.04;   ///< square metres
constexpr double kOff = 1.5;          ///< voxels from the plane
constexpr double kMostExtent = 2.5;   ///< metres from the seed
constexpr double kOutlineStep = 0.2;  ///< metres; upright faces are seen with more noise than tops
constexpr int kRounds = 3;

struct Plane {
  Eigen::Vector3d normal;
  double distance = 0.0;  ///< normal . p = distance, in voxels
  [[nodiscard]] double off(VoxelIndex v) const {
    return normal.dot(Eigen::Vector3d(v.x + 0.5, v.y + 0.5, v.z + 0.5)) - distance;
  }
};

std::optional<Plane> upright_plane(const std::vector<VoxelIndex>& voxels) {
  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const VoxelIndex v : voxels) {
    cloud->emplace_back(static_cast<float>(v.x) + 0.5F, static_cast<float>(v.y) + 0.5F, static_cast<float>(v.z) + 0.5F);
  }
  if (cloud->size() < 3) return std::nullopt;
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // a face that is none is no error
  pcl::SACSegmentation<pcl::PointXYZ> finder(false);
  finder.setModelType(pcl::SACMODEL_PARALLEL_PLANE);
  finder.setMethodType(pcl::SAC_RANSAC);
  finder.setAxis(Eigen::Vector3f::UnitZ());
  finder.setEpsAngle(0.35);  // screens lean
  finder.setDistanceThreshold(1.0);
  finder.setMaxIterations(200);
  finder.setInputCloud(cloud);
  pcl::PointIndices inliers;
  pcl::ModelCoefficients plane;
  finder.segment(inliers, plane);
  if (inliers.indices.size() < 3) return std::nullopt;
  return Plane{{plane.values[0], plane.values[1], plane.values[2]}, -plane.values[3]};
}

std::vector<VoxelIndex> grown(const BrickMasks& candidates, VoxelIndex seed, const Plane& plane, int most) {
  std::set<VoxelIndex> seen{seed};
  std::deque<VoxelIndex> open{seed};
  while (!open.empty()) {
    const VoxelIndex at = open.front();
    open.pop_front();
    for (int i = 0; i < 27; ++i) {
      const VoxelIndex next{at.x + i % 3 - 1, at.y + i / 3 % 3 - 1, at.z + i / 9 - 1};
      const bool near =
          std::abs(next.x - seed.x) <= most && std::abs(next.y - seed.y) <= most && std::abs(next.z - seed.z) <= most;
      if (!near || std::abs(plane.off(next)) > kOff || !candidates.contains(next)) continue;
      if (seen.insert(next).second) open.push_back(next);
    }
  }
  return {seen.begin(), seen.end()};
}

/// Of a face those voxels that make one piece, seen along its normal: what else stands in its plane has another
/// outline.
std::vector<VoxelIndex> one_piece(const std::vector<VoxelIndex>& face, VoxelIndex seed, const Plane& plane,
                                  double resolution) {
  const Eigen::Vector2d along(-plane.normal.y(), plane.normal.x());
  const Eigen::Vector2d unit = along.normalized();
  const auto cell_of = [&](VoxelIndex v) {
    return std::pair(static_cast<std::int32_t>(std::lround(unit.dot(Eigen::Vector2d(v.x, v.y)))), v.z);
  };
  std::set<std::pair<std::int32_t, std::int32_t>> cells;
  for (const VoxelIndex v : face) cells.insert(cell_of(v));
  const auto piece = rectangle_around({cells.begin(), cells.end()}, {}, cell_of(seed), resolution, kOutlineStep, 1);
  const std::set<std::pair<std::int32_t, std::int32_t>> kept(piece.cells.begin(), piece.cells.end());
  std::vector<VoxelIndex> out;
  for (const VoxelIndex v : face) {
    if (kept.contains(cell_of(v))) out.push_back(v);
  }
  return out;
}

}  // namespace

std::optional<BrickMasks> find_upright_face(const BrickMasks& candidates, VoxelIndex seed, double resolution) {
  const int around = static_cast<int>(std::lround(kAround / resolution));
  std::vector<VoxelIndex> face;
  for (int x = -around; x <= around; ++x) {
    for (int y = -around; y <= around; ++y) {
      for (int z = -around; z <= around; ++z) {
        const VoxelIndex v{seed.x + x, seed.y + y, seed.z + z};
        if (candidates.contains(v)) face.push_back(v);
      }
    }
  }
  std::optional<Plane> plane;
  for (int round = 0; round < kRounds; ++round) {
    const auto next = upright_plane(face);
    if (!next || std::abs(next->off(seed)) > 2 * kOff) break;
    plane = next;
    face = grown(candidates, seed, *plane, static_cast<int>(std::lround(kMostExtent / resolution)));
  }
  if (plane) face = one_piece(face, seed, *plane, resolution);
  if (!plane || static_cast<double>(face.size()) * resolution * resolution < kLeastArea) return std::nullopt;
  return masks_of(face);
}

}  // namespace concord
