#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "agent/sim/voxel_set.hpp"

namespace concord {

/// What light does on a surface: glass lets it through, a mirror sends it elsewhere, black swallows most of it.
enum class Material { kOpaque, kGlass, kMirror, kBlack };

/// A box standing upright, turned by `yaw` about its centre. Map frame, metres.
struct Solid {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d half = Eigen::Vector3d::Zero();  ///< half its edges, along its own axes
  double yaw = 0;
  Material material = Material::kOpaque;
};

[[nodiscard]] Eigen::AlignedBox3d bounds(const Solid& solid);

/// Something in the hall that sensors find hard: scored on its own.
struct Feature {
  std::string name;
  std::vector<std::size_t> solids;
  Eigen::AlignedBox3d region;  ///< only surface in here counts: not what touches the floor or another thing
  std::optional<Eigen::AlignedBox3d> edit_box;  ///< what a person would pin occupied, where one box will do
};

/// A straight way that a robot is asked to take.
struct Errand {
  Eigen::Vector2d from, to;
};

/// A hall and what stands in it. The map frame: floor at z = 0, one inner corner of the hall at the origin.
struct World {
  Eigen::AlignedBox3d hall;
  std::vector<Solid> solids;
  std::vector<Feature> features;
  Errand through_glass;  ///< looks free to every sensor, but the glass wall stands across it; a doorway leads round
};

inline constexpr double kHallX = 24, kHallY = 16, kHallZ = 5;

/// The same seed gives the same warehouse: shelves, a glass wall, an aisle 0.5 m wide, a reflective plate, a low black
/// stand, tables, pallets, an office with a doorway. The seed moves goods and pallets; what has a name stays.
[[nodiscard]] World make_warehouse(std::uint64_t seed);

/// The voxels that the surface of a solid passes through.
[[nodiscard]] VoxelSet surface(const World& world, double resolution);
/// Those of one feature, as far as their centres lie in its region.
[[nodiscard]] VoxelSet surface(const World& world, const Feature& feature, double resolution);

}  // namespace concord
