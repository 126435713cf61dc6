#pragma once

#include <optional>
#include <string>

#include "cli/command.hpp"
#include "core/transform.hpp"

namespace concord {

/// `align` on two map files.
struct AlignFiles {
  std::string source, target;
  std::optional<Transform> T_target_source;  ///< the guess
  std::string picture;                       ///< a PNG; empty: none
};

/// Whether the name says that it is a file that `align` reads: .bt, .ot, .pcd or .ply.
[[nodiscard]] bool is_alignable_file(const std::string& name);

/// Prints where the source lies in the target. @return kRefused where that is not sure.
[[nodiscard]] Outcome align_files(const AlignFiles& files, const Common& common);

}  // namespace concord
