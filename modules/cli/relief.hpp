#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "cli/overview.hpp"

namespace concord {

struct Rgb {
  float r = 0, g = 0, b = 0;  ///< 0 to 1

  [[nodiscard]] constexpr Rgb mixed(const Rgb& other, float share) const {
    return {r + (other.r - r) * share, g + (other.g - g) * share, b + (other.b - b) * share};
  }
  [[nodiscard]] constexpr Rgb scaled(float factor) const { return {r * factor, g * factor, b * factor}; }
};

/// The colour that stands for the i-th agent. Red, burgundy, cyan and green are kept for paths, edits and conflicts.
[[nodiscard]] Rgb agent_colour(std::size_t i);

/// A map seen from straight above, one cell per column of voxels.
struct Relief {
  struct Cell {
    float top = -std::numeric_limits<float>::infinity();  ///< of the highest surface under the cut, metres
    std::uint32_t claims = 0;                             ///< bit i: agent i holds that surface occupied
    bool seen = false;                                    ///< free or occupied anywhere under the cut
    std::uint16_t conflicts = 0;  ///< voxels of the column in which submaps contradict each other

    [[nodiscard]] bool solid() const { return top > -std::numeric_limits<float>::infinity(); }
  };

  std::int32_t min_x = 0, min_y = 0;  ///< voxel index of the first cell
  int width = 0, height = 0;          ///< cells
  double floor = 0.0;                 ///< height of most of the ground, metres
  std::vector<Cell> cells;            ///< rows of ascending y, x fastest

  /// The cell of a column of voxels; null when it is off the picture.
  [[nodiscard]] Cell* at(std::int32_t x, std::int32_t y) {
    const bool inside = x >= min_x && y >= min_y && x < min_x + width && y < min_y + height;
    return inside ? &cells[static_cast<std::size_t>(y - min_y) * width + (x - min_x)] : nullptr;
  }
};

/// Looks down on the map. Far outliers (at most a fiftieth of the columns on each side) are left off the picture,
/// routes, edits, start and goal never are. @return a relief without cells where the map has nothing under the cut.
[[nodiscard]] Relief look_down(const Overview& overview);

/// Light from the upper left, soft shadows, darker corners: opaque 0xFFRRGGBB or 0 (nothing known), rows as in
/// `relief`.
[[nodiscard]] std::vector<std::uint32_t> shade(const Relief& relief, double resolution, double cut);

}  // namespace concord
