#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "core/corrections.hpp"

namespace concord {

/// Where things are, as the client says it: metres, map frame.

/// The space of all voxels from `min` to `max`, both included.
[[nodiscard]] Box extent(VoxelIndex min, VoxelIndex max, double resolution);
/// Around a volume, along the map's axes.
[[nodiscard]] Box extent(const Volume& volume, const Transform& T_map_volume);

/// "0.00..1.00  2.00..3.05  0.00..1.80", x, y and z.
[[nodiscard]] std::string to_words(const Box& extent);
inline const char* const kExtentHeading = "where: x, y, z (m)";

/// {"min": [x, y, z], "max": [x, y, z]}
[[nodiscard]] nlohmann::json to_json(const Box& extent);
/// Its kind, its numbers as the options of the same names take them, and T_map_volume.
[[nodiscard]] nlohmann::json to_json(const Volume& volume, const Transform& T_map_volume);
/// "box", "oriented box" or "prism".
[[nodiscard]] const char* kind_of(const Volume& volume);
/// "no-go" or "allow-contact".
[[nodiscard]] const char* name(Zone::Kind kind);

}  // namespace concord
