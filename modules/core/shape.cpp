#include "core/shape.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/convex_cells.hpp"
#include "core/decimal.hpp"
#include "core/shape_pieces.hpp"
#include "core/voxel_runs.hpp"

namespace concord {
namespace {

/// A band of heights thinner than this, in voxels, is none.
constexpr double kThinnestBand = 0.01;
/// Points of a volume's boundary are its own, metres.
constexpr double kOnBoundary = 1e-6;
/// Resolutions nearer than this are one, metres.
constexpr double kSameResolution = 1e-9;

/// What a selection may look at on the way: pieces that overlap, and cells beside a round end, cost work and give no
/// voxel; no shape that a person draws comes near.
std::int64_t work_for(std::int64_t most) { return 16 * most + 1'000'000; }

/// A triangle narrower than this, in voxels, has no certain normal, and its edges are as near as its middle.
constexpr double kSliver = 1e-3;

double distance2_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d edge = b - a;
  const double length2 = edge.squaredNorm();
  const double share = length2 > 0 ? std::clamp((p - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
  return (a + share * edge - p).squaredNorm();
}

double distance2_to_triangle(const Eigen::Vector3d& p, const std::vector<Eigen::Vector3d>& corners) {
  const Eigen::Vector3d &a = corners[0], &b = corners[1], &c = corners[2];
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double longest2 = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  const double width2 = normal.squaredNorm() / longest2;
  const auto left_of = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return normal.dot((to - from).cross(p - from)) > 0;
  };
  if (width2 > kSliver * kSliver && left_of(a, b) && left_of(b, c) && left_of(c, a)) {
    const double height = normal.dot(p - a);
    return height * height / normal.squaredNorm();
  }
  return std::min({distance2_to_segment(p, a, b), distance2_to_segment(p, b, c), distance2_to_segment(p, c, a)});
}

bool is_within(const ConvexPiece& piece, VoxelIndex voxel, double radius) {
  const Eigen::Vector3d p = centre_of(voxel, 1.0);
  const double distance2 = piece.corners.size() == 2 ? distance2_to_segment(p, piece.corners[0], piece.corners[1])
                                                     : distance2_to_triangle(p, piece.corners);
  return distance2 <= (radius + kOnFace) * (radius + kOnFace);
}

tl::unexpected<Error> refuse_out_of_bounds() {
  return refuse(Code::kOutOfBounds, "the shape reaches beyond the map; is it in metres, and in the right frame?");
}

/// The voxels that a part of a line or an area touches, and those whose centre is within `radius` voxels of it.
struct ThickPart {
  const ConvexPiece& piece;
  double radius;
  VoxelRuns& runs;
  std::int64_t& work;
  ConvexCells touched{piece, kOnFace};
  ConvexCells reachable{piece, kOnFace, radius};

  [[nodiscard]] bool add_all() {
    return visit_columns(reachable, work,
                         [this](std::int32_t x, std::int32_t y, std::int32_t first, std::int32_t last) {
                           return radius == 0 ? runs.add(x, y, first, last) : add_column(x, y, first, last);
                         });
  }

  /// The part is convex, so what is near it in a column is in one run: looks for the two ends of that.
  bool add_column(std::int32_t x, std::int32_t y, std::int32_t first, std::int32_t last) {
    const auto is_near = [&](std::int32_t z) { return --work >= 0 && is_within(piece, {x, y, z}, radius); };
    const auto add_touched = [&](std::int32_t z) { return !touched.holds({x, y, z}) || runs.add(x, y, z, z); };
    for (; first <= last && !is_near(first); ++first) {
      if (work < 0 || !add_touched(first)) return false;
    }
    for (; last > first && !is_near(last); --last) {
      if (work < 0 || !add_touched(last)) return false;
    }
    return first > last || runs.add(x, y, first, last);
  }
};

Result<std::vector<VoxelIndex>> gather_touched(const std::vector<ConvexPiece>& pieces, double radius,
                                               std::int64_t most) {
  VoxelRuns runs(most);
  std::int64_t work = work_for(most);
  for (const ConvexPiece& piece : pieces) {
    ThickPart part{piece, radius, runs, work};
    if (!part.reachable.in_bounds()) return refuse_out_of_bounds();
    if (!part.add_all() || !runs.end_part()) return refuse_too_many(most);
  }
  return runs.take();
}

/// The cells of a volume's pieces.
Result<std::vector<VoxelIndex>> gather(const std::vector<ConvexPiece>& pieces, std::int64_t most) {
  VoxelRuns runs(most);
  std::int64_t work = work_for(most);
  for (const ConvexPiece& piece : pieces) {
    const ConvexCells cells(piece, -kOnFace);
    if (!cells.in_bounds()) return refuse_out_of_bounds();
    const auto add = [&](std::int32_t x, std::int32_t y, std::int32_t first, std::int32_t last) {
      return runs.add(x, y, first, last);
    };
    if (!visit_columns(cells, work, add) || !runs.end_part()) return refuse_too_many(most);
  }
  return runs.take();
}

/// Those that a volume's pieces touch in the layer z = 0, as runs along y: of (x, 0, first y) to (x, 0, last y).
Result<VoxelRuns> gather_ground(const std::vector<ConvexPiece>& pieces, std::int64_t most) {
  VoxelRuns runs(most);
  std::int64_t work = work_for(most);
  for (const ConvexPiece& piece : pieces) {
    ConvexCells cells(piece, kOnFace);
    cells.cut_to_ground();
    if (!cells.in_bounds()) return refuse_out_of_bounds();
    const auto add = [&](std::int32_t x, std::int32_t first, std::int32_t last) { return runs.add(x, 0, first, last); };
    if (!visit_ground_rows(cells, work, add) || !runs.end_part()) return refuse_too_many(most);
  }
  return runs;
}

struct Select {
  const Transform& T_map_frame;
  double resolution;
  std::int64_t most;
  CellFrame cells{Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(resolution)};

  Result<std::vector<VoxelIndex>> operator()(const VoxelList& list) const {
    if (!(std::abs(list.resolution - resolution) < kSameResolution)) {
      return refuse(Code::kBadResolution,
                    "the voxels are of " + decimal(list.resolution) + " m, the map's of " + decimal(resolution) + " m");
    }
    return expand(list.boxes, most);
  }
  Result<std::vector<VoxelIndex>> operator()(const Line& line) const {
    return gather_touched(pieces_of(line, T_map_frame, cells), 0.5 * line.thickness / resolution, most);
  }
  Result<std::vector<VoxelIndex>> operator()(const Area& area) const {
    return pieces_of(area, T_map_frame, cells).and_then([&](const std::vector<ConvexPiece>& pieces) {
      return gather_touched(pieces, 0.5 * area.thickness / resolution, most);
    });
  }
  template <class SomeVolume>
  Result<std::vector<VoxelIndex>> operator()(const SomeVolume& volume) const {
    return pieces_of(Volume(volume), T_map_frame, cells).and_then([&](const std::vector<ConvexPiece>& pieces) {
      return gather(pieces, most);
    });
  }
};

Result<void> check_placing(const Transform& T_map_frame, double resolution) {
  if (!T_map_frame.matrix().allFinite()) return refuse(Code::kNotFinite, "the frame's transform is not finite");
  if (T_map_frame.translation().cwiseAbs().maxCoeff() > kFarthest) {
    return refuse(Code::kOutOfBounds, "the frame lies beyond the map; is its place in metres?");
  }
  if (!(resolution > 0) || !std::isfinite(resolution))
    return refuse(Code::kBadResolution, "resolution must be above 0");
  return {};
}

}  // namespace

Result<std::vector<VoxelIndex>> select(const Shape& shape, const Transform& T_map_frame, double resolution,
                                       std::int64_t most) {
  return check(shape)
      .and_then([&] { return check_placing(T_map_frame, resolution); })
      .and_then([&] {
        return std::visit(Select{T_map_frame, resolution, most}, shape);
      })
      .and_then([](std::vector<VoxelIndex> voxels) -> Result<std::vector<VoxelIndex>> {
        if (voxels.empty()) return refuse(Code::kEmpty, "the shape is too thin to hold a voxel; draw it thicker");
        return voxels;
      });
}

bool contains(const Volume& volume, const Transform& T_map_frame, const Eigen::Vector3d& p_map) {
  const Eigen::Vector3d p = T_map_frame.inverse() * p_map;
  if (const auto* prism = std::get_if<Prism>(&volume)) {
    return p.z() >= prism->low - kOnBoundary && p.z() <= prism->high + kOnBoundary &&
           encloses(prism->points, p.head<2>(), kOnBoundary);
  }
  const PlacedBox box =
      std::holds_alternative<Box>(volume) ? placed(std::get<Box>(volume)) : placed(std::get<OrientedBox>(volume));
  const Eigen::Array3d q = box.T_frame_corner.inverse() * p;
  return (q >= -kOnBoundary).all() && (q <= box.size.array() + kOnBoundary).all();
}

namespace {

struct CornersOf {
  std::vector<Eigen::Vector3d> operator()(const Box& box) const {
    std::vector<Eigen::Vector3d> corners;
    for (int i = 0; i < 8; ++i) {
      const auto end = [&](int axis) { return (i >> axis & 1) != 0 ? box.max[axis] : box.min[axis]; };
      corners.emplace_back(end(0), end(1), end(2));
    }
    return corners;
  }
  std::vector<Eigen::Vector3d> operator()(const OrientedBox& box) const {
    std::vector<Eigen::Vector3d> corners = (*this)(Box{-0.5 * box.size, 0.5 * box.size});
    for (Eigen::Vector3d& corner : corners) corner = box.T_frame_box * corner;
    return corners;
  }
  std::vector<Eigen::Vector3d> operator()(const Prism& prism) const {
    std::vector<Eigen::Vector3d> corners;
    for (const Eigen::Vector2d& p : prism.points) {
      corners.emplace_back(p.x(), p.y(), prism.low);
      corners.emplace_back(p.x(), p.y(), prism.high);
    }
    return corners;
  }
};

Result<VoxelRuns> ground_runs(const Volume& volume, const Transform& T_map_frame, double resolution, double zmin,
                              double zmax, std::int64_t most) {
  if (auto fine = check_placing(T_map_frame, resolution); !fine) return tl::unexpected(fine.error());
  if (!(std::abs(zmin) <= kFarthest) || !(std::abs(zmax) <= kFarthest) || zmax - zmin < kThinnestBand * resolution) {
    return refuse(Code::kBadRequest, "the lower height must be below the upper, both within the map");
  }
  // One layer of cells as tall as the band: what a cell touches in it is what its voxel would.
  const CellFrame cells{{0, 0, zmin}, {resolution, resolution, zmax - zmin}};
  return check(volume)
      .and_then([&] { return pieces_of(volume, T_map_frame, cells); })
      .and_then([&](const std::vector<ConvexPiece>& pieces) { return gather_ground(pieces, most); });
}

}  // namespace

std::vector<Eigen::Vector3d> corners(const Volume& volume) { return std::visit(CornersOf{}, volume); }

Result<std::vector<VoxelIndex>> footprint(const Volume& volume, const Transform& T_map_frame, double resolution,
                                          double zmin, double zmax, std::int64_t most) {
  return ground_runs(volume, T_map_frame, resolution, zmin, zmax, most)
      .and_then([](VoxelRuns runs) { return runs.take(); })
      .map([](std::vector<VoxelIndex> cells) {
        for (VoxelIndex& cell : cells) std::swap(cell.y, cell.z);
        return cells;
      });
}

Result<std::int64_t> footprint_count(const Volume& volume, const Transform& T_map_frame, double resolution, double zmin,
                                     double zmax, std::int64_t most) {
  return ground_runs(volume, T_map_frame, resolution, zmin, zmax, most).and_then([](VoxelRuns runs) {
    return runs.count();
  });
}

Result<VoxelList> voxel_list(std::span<const VoxelIndex> voxels, double resolution) {
  VoxelList list{resolution, to_boxes(voxels)};
  const auto many = static_cast<std::int64_t>(list.boxes.size());
  if (many <= kMaxSelectionBoxes) return list;
  return refuse(Code::kTooLarge, "its voxels are too scattered for one request (" + std::to_string(many) +
                                     " boxes, at most " + std::to_string(kMaxSelectionBoxes) + ")");
}

}  // namespace concord
