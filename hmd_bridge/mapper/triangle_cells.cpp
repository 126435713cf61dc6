#include "mapper/triangle_cells.hpp"

#include <algorithm>
#include <cmath>

namespace concord::hmd {
namespace {

/// In cells: what lies nearer than this to a face counts as above it.
constexpr double kOnFace = 1e-6;

bool separated(const TriangleCells::Corners& c, const Eigen::Vector3d& axis) {
  const double a = axis.dot(c[0]), b = axis.dot(c[1]), d = axis.dot(c[2]);
  const double reach = 0.5 * axis.cwiseAbs().sum();
  return std::min({a, b, d}) > reach || std::max({a, b, d}) < -reach;
}

/// Its plane is any plane through that line: no axis leaves few cells to look at.
bool is_line(const TriangleCells::Corners& corners) {
  constexpr double kSine = 1e-9;
  const Eigen::Vector3d a = corners[1] - corners[0], b = corners[2] - corners[0];
  return a.cross(b).norm() <= kSine * a.norm() * b.norm();
}

}  // namespace

bool meets(const TriangleCells::Corners& corners, VoxelIndex cell) {
  TriangleCells::Corners c;
  for (std::size_t i = 0; i < 3; ++i) c[i] = corners[i] - centre_of(cell, 1.0);
  for (int axis = 0; axis < 3; ++axis) {
    if (separated(c, Eigen::Vector3d::Unit(axis))) return false;
  }
  const std::array<Eigen::Vector3d, 3> edges{c[1] - c[0], c[2] - c[1], c[0] - c[2]};
  if (separated(c, edges[0].cross(edges[1]))) return false;
  for (const Eigen::Vector3d& edge : edges) {
    for (int axis = 0; axis < 3; ++axis) {
      if (separated(c, edge.cross(Eigen::Vector3d::Unit(axis)))) return false;
    }
  }
  return true;
}

bool TriangleCells::append(Corners corners, std::size_t& budget, std::vector<VoxelIndex>& out) {
  if (is_line(corners)) return true;
  for (Eigen::Vector3d& corner : corners) corner.array() += kOnFace;
  const Eigen::Vector3d low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
  const Eigen::Vector3d high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
  const Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);

  // Along the axis that the triangle faces most, its plane crosses few cells of a column.
  int k = 0;
  normal.cwiseAbs().maxCoeff(&k);
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const double su = -normal[i] / normal[k], sv = -normal[j] / normal[k];
  const double half = 0.5 * (std::abs(su) + std::abs(sv)) + kOnFace;
  const auto cell = [](double at) { return static_cast<std::int32_t>(std::floor(at)); };
  for (std::int32_t u = cell(low[i]); u <= cell(high[i]); ++u) {
    for (std::int32_t v = cell(low[j]); v <= cell(high[j]); ++v) {
      const double at = corners[0][k] + su * (u + 0.5 - corners[0][i]) + sv * (v + 0.5 - corners[0][j]);
      const double from = std::max(low[k], at - half), to = std::min(high[k], at + half);
      if (budget-- == 0) return ++budget, false;
      for (std::int32_t w = cell(from); w <= cell(to); ++w) {
        if (budget-- == 0) return ++budget, false;
        std::array<std::int32_t, 3> index;
        index[static_cast<std::size_t>(i)] = u;
        index[static_cast<std::size_t>(j)] = v;
        index[static_cast<std::size_t>(k)] = w;
        const VoxelIndex voxel{index[0], index[1], index[2]};
        if (meets(corners, voxel)) out.push_back(voxel);
      }
    }
  }
  return true;
}

}  // namespace concord::hmd
