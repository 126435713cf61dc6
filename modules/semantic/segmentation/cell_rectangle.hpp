#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace concord {

inline constexpr int kDirections = 18;  ///< 5 degrees apart; 1: along the cells' own axes

/// Of cells that hang together, those that make one piece of furniture.
struct CellRectangle {
  std::vector<std::pair<std::int32_t, std::int32_t>> cells;  ///< sorted; holes filled
  double width = 0.0, length = 0.0;                          ///< of the rectangle around them, metres
};

/// The piece that holds `seed`: from it, strip by strip in both axes of a rectangle, until strips are wider than those
/// before by `step` metres or more, for good: there another piece stands beside it. Where a strip ends at a cell of
/// `covered`, on which something stands or leans, its end says nothing of the outline. Of `directions` the one is taken
/// whose cells, times the fourth power of the share of their rectangle that they fill, are most: a wrong direction sees
/// no outline.
/// @pre `seed` is one of `cells`.
[[nodiscard]] CellRectangle rectangle_around(const std::vector<std::pair<std::int32_t, std::int32_t>>& cells,
                                             const std::vector<std::pair<std::int32_t, std::int32_t>>& covered,
                                             std::pair<std::int32_t, std::int32_t> seed, double resolution, double step,
                                             int directions = kDirections);

}  // namespace concord
