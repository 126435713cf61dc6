#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/error.hpp"

namespace concord {

/// What holds for all things of a class.
struct ClassRule {
  double margin = 0.0;  ///< metres that robots keep from them, 0 to 10; 0: no more than from anything
};

/// Reads a file of them, a line for each class:
///
///     fork lift: {margin: 0.5}
///
/// No such file: no rule. Refused: anything else in it (kMalformed), a name that is none (kBadName), over kMaxClasses
/// (kTooLarge).
[[nodiscard]] Result<std::map<std::string, ClassRule>> read_class_rules(const std::filesystem::path& file);

}  // namespace concord
