#pragma once

#include <cstdint>

#include "core/map_archive.hpp"
#include "core/map_archive_sections.hpp"

namespace concord::archive {

/// What stands in the sections of a map file (map_archive.md).

/// Refused (kBadName, kBadRequest): a name or a weight that is none.
[[nodiscard]] Result<void> check(const LayerHead& head);

/// What the layers of one file may still hold.
struct Room {
  std::uint64_t layers = kMaxArchiveLayers;
  std::uint64_t bricks = kMaxArchiveBricks;
  std::uint64_t voxels = kMaxArchiveVoxels;
  std::uint64_t pins = kMaxArchivePins;
  std::uint64_t corrections = kMaxArchiveCorrections;

  /// One layer, or one correction, less. Refused (kTooLarge), and nothing taken.
  [[nodiscard]] Result<void> take_layer(std::uint64_t its_bricks, std::uint64_t its_voxels);
  [[nodiscard]] Result<void> take_correction(const Correction& correction);
};

/// @pre check(head).
void append_layer(Bytes& out, const LayerHead& head, const BrickMap& bricks);
/// The content of a whole section. Refused: what no append_layer writes (kMalformed), over `room` or
/// `options.known_voxels` (kTooLarge).
[[nodiscard]] Result<SavedLayer> read_layer(ByteSpan content, const MapArchiveOptions& options, Room& room);

/// @pre CorrectionCheck took it.
void append_correction(Bytes& out, const Correction& correction);
/// The next of a section, not checked but for its bytes. Refused (kMalformed, kTooLarge).
[[nodiscard]] Result<Correction> read_correction(FieldReader& in, Room& room);

}  // namespace concord::archive
