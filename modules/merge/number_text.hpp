#pragma once

#include <string>
#include <string_view>

#include "core/error.hpp"
#include "core/shape.hpp"

namespace concord {

/// Volumes and rotations as text that is read in the sqlite3 shell and read back to the bit.

/// "box XMIN YMIN ZMIN XMAX YMAX ZMAX", "oriented_box SX SY SZ  X Y Z  R11 R12 ... R33", "prism LOW HIGH X1 Y1 X2 Y2
/// ...".
[[nodiscard]] std::string to_text(const Volume& volume);
/// Refused (kMalformed): what to_text never wrote, or a volume that is none.
[[nodiscard]] Result<Volume> volume_from_text(std::string_view text);

/// Nine numbers, row by row.
[[nodiscard]] std::string to_text(const Eigen::Matrix3d& rotation);
/// Refused (kMalformed): what to_text never wrote, or no rotation.
[[nodiscard]] Result<Eigen::Matrix3d> rotation_from_text(std::string_view text);

}  // namespace concord
