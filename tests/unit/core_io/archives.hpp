#pragma once

#include <rapidcheck.h>

#include <optional>
#include <string>
#include <vector>

#include "core/map_archive.hpp"

namespace concord::test {

/// The file of an archive. @pre it is one that can be written.
[[nodiscard]] Bytes write(const MapArchive& archive);

[[nodiscard]] bool same(const Correction& a, const Correction& b);
[[nodiscard]] bool same(const MapArchive& a, const MapArchive& b);

[[nodiscard]] Correction correction(std::int64_t revision, std::string id, decltype(Correction::what) what);
[[nodiscard]] Correction::Edit edit_of(std::vector<VoxelIndex> added);
[[nodiscard]] Correction::ZoneChange zone_of(ZoneRequest::Op op, std::string name, Volume volume);

/// A small archive with everything in it once.
[[nodiscard]] MapArchive small_archive();

/// Layers from empty to scattered over all the lattice, and corrections of all kinds that may follow one another.
[[nodiscard]] rc::Gen<MapArchive> arbitrary_archive();

}  // namespace concord::test
