#pragma once

#include "store/database.hpp"

namespace concord {

/// The resolution that what a file keeps is for, in metres: as its table `site` says, which is `resolution` from the
/// first time on. Voxels by number mean nothing at another one.
/// @throws std::runtime_error if the table cannot be read or written.
[[nodiscard]] double kept_resolution(Database& database, double resolution);

}  // namespace concord
