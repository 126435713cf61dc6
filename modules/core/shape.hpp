#pragma once

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "core/error.hpp"
#include "core/lattice.hpp"
#include "core/polygon.hpp"
#include "core/transform.hpp"
#include "core/voxel_boxes.hpp"

namespace concord {

/// What people draw to select a part of the map, or to fence one off: plain values in a frame of their own, metres.
///
/// One rule for what a line or an area takes: **every voxel that it touches**, be it at a corner (so one that runs
/// along the face between two layers takes both); with a thickness also every voxel whose centre is within half of it.
/// One rule for all volumes: **every voxel that shares volume with it**. A side of no thickness is a side all the same
/// and takes the layer of voxels that it runs through, or, on the face between two, the upper: a pane of glass drawn
/// flat is still there. Touching and sharing are told apart at kOnFace, so a box from k r to m r takes exactly the
/// voxels k to m - 1 however its corners were rounded, moved or turned.

/// Nearer than this to a voxel's face, in voxels, is on it: 1.15 / 0.05 is not exactly 23.
inline constexpr double kOnFace = 1e-6;
/// The points of an area may lie this far from the plane through them, metres: hands tremble.
inline constexpr double kMaxOffPlane = 0.05;

struct Line {
  std::vector<Eigen::Vector3d> points;  ///< 2 to kMaxShapePoints; equal ones are a point
  double thickness = 0;
};

struct Area {
  std::vector<Eigen::Vector3d> points;  ///< a simple polygon, convex or not; taken where they are, not flattened
  double thickness = 0;
};

/// Along the axes of its frame.
struct Box {
  Eigen::Vector3d min = Eigen::Vector3d::Zero();
  Eigen::Vector3d max = Eigen::Vector3d::Zero();
};

struct OrientedBox {
  Transform T_frame_box = Transform::Identity();   ///< the box's centre and axes
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< whole edges
};

/// A simple polygon in x and y of its frame, from z = low to z = high.
struct Prism {
  std::vector<Eigen::Vector2d> points;
  double low = 0;
  double high = 0;
};

/// Voxels of the map's lattice, wherever the shape's frame is.
struct VoxelList {
  double resolution = 0;  ///< of that lattice, metres
  std::vector<VoxelBox> boxes;
};

inline constexpr std::int64_t kMaxSelectionBoxes = 65'536;  ///< in one request: lcmtypes/shape_t.lcm
/// Sorted and unique voxels as a request has them. Refused (kTooLarge): so scattered that they are over
/// kMaxSelectionBoxes boxes.
[[nodiscard]] Result<VoxelList> voxel_list(std::span<const VoxelIndex> voxels, double resolution);

using Shape = std::variant<VoxelList, Line, Area, Box, OrientedBox, Prism>;
using Volume = std::variant<Box, OrientedBox, Prism>;

/// Whether a shape is one, wherever it lies. Refused: NaN or infinity (kNotFinite); too few points, no area, a polygon
/// that crosses or touches itself or is not plane, a negative size or thickness, a box turned inside out (kBadShape);
/// an oriented box whose transform is no rotation (kBadTransform); over kMaxShapePoints (kTooLarge); a coordinate or
/// voxel beyond any map (kOutOfBounds); a list of no voxels (kEmpty), or one of no resolution (kBadResolution).
[[nodiscard]] Result<void> check(const Shape& shape);
[[nodiscard]] Result<void> check(const Volume& volume);

/// The voxels of the map that a shape takes, by the rules above; sorted and unique. `T_map_frame` places the shape's
/// frame in the map (a VoxelList does not heed it). Refused: what `check` refuses; a resolution that is none, or a
/// VoxelList of another (kBadResolution); voxels beyond kMaxVoxel (kOutOfBounds); over `most` voxels, found out by
/// counting before memory is taken for them, or so many parts of it in one place that counting is dear (kTooLarge);
/// none, which only a prism far thinner than kOnFace has (kEmpty). Time and memory are bounded by `most`, whatever the
/// shape. @pre T_map_frame is a rotation and a translation (make_transform); most < 2^40.
[[nodiscard]] Result<std::vector<VoxelIndex>> select(const Shape& shape, const Transform& T_map_frame,
                                                     double resolution, std::int64_t most);

/// Points of the volume's frame whose hull holds it, and which lie on it.
[[nodiscard]] std::vector<Eigen::Vector3d> corners(const Volume& volume);

/// Whether a point of the map lies in a volume or within a micrometre of it. @pre check(volume).
[[nodiscard]] bool contains(const Volume& volume, const Transform& T_map_frame, const Eigen::Vector3d& p_map);

/// The cells of the map's 2D grid, as voxels with z = 0, whose square the volume touches anywhere between the heights
/// `zmin` and `zmax` (metres, map frame); sorted and unique, empty when it lies below or above. On the safe side: a
/// common edge or corner is a touch. Refused: as by `select`, and zmin not below zmax by a
/// hundredth of a voxel (kBadRequest).
[[nodiscard]] Result<std::vector<VoxelIndex>> footprint(const Volume& volume, const Transform& T_map_frame,
                                                        double resolution, double zmin, double zmax, std::int64_t most);
/// How many those are, at the cost of their rows. Refused likewise.
[[nodiscard]] Result<std::int64_t> footprint_count(const Volume& volume, const Transform& T_map_frame,
                                                   double resolution, double zmin, double zmax, std::int64_t most);

}  // namespace concord
