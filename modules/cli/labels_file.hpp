#pragma once

#include <string>

#include "cli/command.hpp"
#include "cli/live.hpp"

namespace concord {

/// Refused (kBadName): a file that ends neither in .pcd nor in .ply.
[[nodiscard]] Result<void> check_labels_file(const std::string& file);

/// Writes the map with its labels: just what semantic says is labelled, or nothing (kIncomplete) where that changes all
/// the while.
[[nodiscard]] Outcome save_labels(const std::string& file, Live& live, const Common& common);

/// Labels the running map as such a file says, with its numbers: all of it, or where one is refused none. What is not
/// occupied here is left out, and said.
[[nodiscard]] Outcome load_labels(const std::string& file, const std::string& author, Live& live, const Common& common);

}  // namespace concord
