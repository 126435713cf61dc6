#pragma once

#include <filesystem>
#include <string>

#include "align/align_map.hpp"
#include "core/error.hpp"
#include "core/transform.hpp"

namespace concord {

/// Two maps laid over each other from above, before and after.
struct AlignPage {
  std::string target, source;  ///< how they are called
  std::string verdict;         ///< a line for people
  const AlignMap* target_map = nullptr;
  const AlignMap* source_map = nullptr;
  Transform T_target_source_before = Transform::Identity();
  Transform T_target_source_after = Transform::Identity();
};

/// Draws the walls of both as a PNG, side by side; what is drawn of one covers what both have in `after`.
/// Refused: a map without walls (kEmpty), a file that cannot be written (kIo).
[[nodiscard]] Result<void> write_align_page(const AlignPage& page, const std::filesystem::path& png);

}  // namespace concord
