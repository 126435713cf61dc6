#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "cli/overview.hpp"

namespace concord {

/// Closed lines in the map frame, metres.
using Outlines = std::vector<std::vector<Eigen::Vector2d>>;

/// Draws them thin over the page that write_overview has written, where `frame` says the map lies on it.
/// Refused: a file that cannot be read or written (kIo).
[[nodiscard]] Result<void> draw_outlines(const Outlines& outlines, const OverviewFrame& frame,
                                         const std::filesystem::path& png);

}  // namespace concord
