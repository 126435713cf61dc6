#pragma once

#include <optional>
#include <vector>

#include "planner/footprint/standing_room.hpp"

namespace concord {

/// The first of a path's cells in which a footprint has no room, whatever its yaw, at the centre or half a cell beside
/// it; of many yaws, so a place that it just fits into may be taken for one. Cells within `near` cells of the path's
/// ends are left out.
[[nodiscard]] std::optional<Cell> first_too_narrow(const StandingRoom& room, const std::vector<Cell>& cells,
                                                   double near);

}  // namespace concord
