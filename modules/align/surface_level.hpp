#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "align/cell_table.hpp"
#include "align/surface.hpp"

namespace concord {

/// What lies in one cell: a flat piece of surface, or something that is none.
struct SurfaceCell {
  Eigen::Vector3f mean;    ///< of the points in the cell, metres
  Eigen::Vector3f normal;  ///< unit length; zero where the points around are no plane
  bool one_sided = false;  ///< free space lies on one side only, and the normal points there; else either sign
  bool is_solid = false;   ///< no plane, but too dense for noise: furniture, edges
  [[nodiscard]] bool is_flat() const { return !normal.isZero(0.0F); }
};

/// Whether both are seen from one side, and not from the same: the two faces of a wall, a floor and a ceiling.
[[nodiscard]] inline bool back_to_back(const SurfaceCell& a, const SurfaceCell& b, double cosine) {
  return a.one_sided && b.one_sided && cosine < 0.0;
}

/// Number, sum and sum of outer products (xx, xy, xz, yy, yz, zz) of points: sums of these are those of the union.
struct Moments {
  double count = 0.0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 6, 1> outer = Eigen::Matrix<double, 6, 1>::Zero();
  void add(const Eigen::Vector3d& p);
  void add(const Moments& other);
};

/// A surface at one size of cells, as a voxelised GICP has it (Koide et al., ICRA 2021): a mean for each cell, and a
/// normal from the points of the 3 x 3 x 3 cells around.
class SurfaceLevel {
 public:
  /// @pre size > 0, points within kMaxSurfaceReach.
  SurfaceLevel(std::span<const Eigen::Vector3f> points, double size, int threads);
  /// The same surface in larger cells.
  SurfaceLevel(const SurfaceLevel& finer, double size, int threads);

  [[nodiscard]] double size() const { return size_; }
  [[nodiscard]] const std::vector<SurfaceCell>& cells() const { return cells_; }
  /// Metres across the median flat piece, one standard deviation: what is left of noise and lattice.
  [[nodiscard]] double thickness() const { return thickness_; }
  /// The points without those that lie off the plane around them, by over twice the thickness: strays near a wall make
  /// it look thick. What is around no plane stays. @pre the points that this was made of.
  [[nodiscard]] SurfacePoints without_strays(const SurfacePoints& points, int threads) const;
  /// Turns the normals of cells that `is_free` on one side only.
  void orient(const std::function<bool(const Eigen::Vector3d&)>& is_free);
  /// The cell with the nearest mean among the eight whose centres are nearest; none: null. It finds whatever lies
  /// within size / 2, and nothing beyond 2.6 size.
  [[nodiscard]] const SurfaceCell* nearest(const Eigen::Vector3d& p) const;

 private:
  void find_planes(int threads);
  [[nodiscard]] Moments around(VoxelIndex cell, int& neighbours) const;
  void find_solids(const std::vector<char>& crowded);

  [[nodiscard]] double median_of_flat(const std::vector<double>& values) const;

  double thickness_ = 0.0;
  double size_;
  double per_metre_;
  CellTable table_;
  std::vector<Moments> moments_;  // as numbered by table_
  std::vector<SurfaceCell> cells_;
};

}  // namespace concord
