#pragma once

#include <array>
#include <optional>
#include <vector>

#include "agent/sim/world.hpp"

namespace concord {

/// From `origin` along the unit vector `direction`, map frame.
struct Ray {
  Eigen::Vector3d origin, direction;
};

struct Hit {
  double distance;    ///< metres
  std::size_t solid;  ///< index in World::solids
};

/// Where the ray enters the solid; nothing if it misses it, starts inside it or has passed it.
[[nodiscard]] std::optional<double> enters(const Ray& ray, const Solid& solid);

enum class Glass { kStops, kLetsThrough };

/// Nearest hits in a world, over a grid of cells that know the solids in them.
class RayCaster {
 public:
  /// Keeps a copy of what it needs.
  explicit RayCaster(const World& world);

  /// The first solid within `range` metres; of two at the same distance the one with the lower index.
  [[nodiscard]] std::optional<Hit> cast(const Ray& ray, double range, Glass glass) const;

  [[nodiscard]] Material material(std::size_t solid) const { return solids_[solid].material; }

 private:
  /// A solid with what its test against a ray needs.
  struct Box {
    Eigen::Vector3d centre, half;
    double cos, sin;
    Material material;
  };

  static std::optional<double> enters(const Ray& ray, const Box& box);
  friend std::optional<double> concord::enters(const Ray& ray, const Solid& solid);
  void test_cell(std::size_t cell, const Ray& ray, Glass glass, std::optional<Hit>& nearest) const;

  std::vector<Box> solids_;
  Eigen::Vector3d low_, high_;
  std::array<int, 3> size_{};
  std::vector<std::uint32_t> first_;  ///< per cell: where its list begins in `listed_`
  std::vector<std::uint32_t> listed_;
};

}  // namespace concord
