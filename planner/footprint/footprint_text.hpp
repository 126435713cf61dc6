#pragma once

#include <string_view>

#include "core/error.hpp"
#include "planner/footprint/footprint.hpp"
#include "planner/footprint/pose.hpp"

namespace concord {

/// "LENGTHxWIDTH", as "1.2x0.8", or corners "x y, x y, x y, ...", metres.
/// Refused: text that is neither (kMalformed), over kMaxFootprintText (kTooLarge), and what Footprint::make refuses.
[[nodiscard]] Result<Footprint> read_footprint(std::string_view text);
inline constexpr std::size_t kMaxFootprintText = 8192;

/// "x y yaw", or "x y" with a yaw of 0; metres and radians, spaces or commas between them.
/// Refused: other text (kMalformed), numbers that are none (kNotFinite).
[[nodiscard]] Result<Pose> read_pose(std::string_view text);

}  // namespace concord
