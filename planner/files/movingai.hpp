#pragma once

#include <string_view>
#include <vector>

#include "core/error.hpp"
#include "planner/lattice/open_grid.hpp"

namespace concord {

/// The benchmark formats of movingai.com (Sturtevant 2012).

/// A `.map` file's text: `.`, `G` and `S` are open, `@`, `O`, `T` and `W` blocked; row 0 is y = 0.
/// Refused: what is not such a text, or has not as many rows as it says (kMalformed); more cells than an OpenGrid holds
/// (kTooLarge).
[[nodiscard]] Result<OpenGrid> read_movingai_map(std::string_view text);

struct ScenarioQuery {
  Cell start, goal;
  double optimum = 0;   ///< cells; over eight directions, a diagonal only if both cells beside it are open
  double rounding = 0;  ///< to so much is it given
};

/// A `.scen` file's text, version 1, for a map of this size.
/// Refused: another text, and cells or sizes that do not fit the map (kMalformed); over kMaxQueries (kTooLarge).
[[nodiscard]] Result<std::vector<ScenarioQuery>> read_movingai_scenario(std::string_view text, int width, int height);
inline constexpr std::size_t kMaxQueries = 1'000'000;

}  // namespace concord
