#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "core/brick_map.hpp"

namespace concord::soak {

inline constexpr double kResolution = 0.1;
/// The soak's people work within this distance of the origin, metres.
inline constexpr double kHalfWidth = 6.0;
inline constexpr double kHeight = 3.0;

/// What two robots saw of the same rooms, each in its own frame: walls, a floor, free space between them, noise.
/// Submaps do not change during a soak; what is done to them by people does.
[[nodiscard]] std::map<std::string, BrickMap> submaps(std::uint32_t seed);

}  // namespace concord::soak
