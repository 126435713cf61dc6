#pragma once

#include "core/octomap_reader.hpp"
#include "core/octomap_writer.hpp"
#include "must.hpp"

namespace concord::fuzz {

/// Small, so that what a few bytes may ask for stays within the fuzzer's memory and time.
inline constexpr OctomapLimits kSmallLimits{.bytes = 1 << 20, .known_voxels = 1 << 20, .bricks = 1 << 12};

/// A map that was taken is within the limits and is read again as itself.
inline void check_import(const Result<OctomapImport>& read) {
  if (!read) return;
  must(read->map.brick_count() <= kSmallLimits.bricks);
  const Result<Bytes> written = write_octomap_file(read->map, read->resolution, OctomapFormat::kFull);
  if (!written) {
    // A finer lattice than OctoMap's keys reach.
    must(written.error().code == Code::kOutOfBounds);
    return;
  }
  const Result<OctomapImport> again =
      read_octomap_file(*written, std::nullopt, {.bytes = std::size_t{1} << 30, .known_voxels = 1 << 30});
  must(again.has_value());
  must(again->map == read->map);
  must(again->resolution == read->resolution);
}

}  // namespace concord::fuzz
