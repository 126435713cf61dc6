#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/brick_map.hpp"
#include "core/byte_stream.hpp"
#include "core/corrections.hpp"
#include "core/error.hpp"

namespace concord {

/// The native map file, `NAME.concord`: all that a map is made of, so that it can be taken apart and merged again.
/// map_archive.md says what stands in it, byte by byte. Values in, bytes out; no files here.

/// Caps of any file. What is beyond them is neither written nor read.
inline constexpr std::size_t kMaxArchiveBytes = 1'000'000'000;
inline constexpr std::size_t kMaxArchiveLayers = 1000;
inline constexpr std::uint64_t kMaxArchiveBricks = 8'000'000;      ///< of all layers
inline constexpr std::uint64_t kMaxArchiveVoxels = 1'000'000'000;  ///< known, of all layers
inline constexpr std::uint64_t kMaxArchiveCorrections = 2'000'000;
inline constexpr std::uint64_t kMaxArchivePins = 100'000'000;  ///< voxels pinned by all edits, undone ones included

/// Whose layer it was.
struct LayerHead {
  std::string agent;
  std::string kind;
  std::string frame_id;
  std::int64_t incarnation = 0;  ///< when it was saved: says which placements among the corrections are this layer's
  int weight = 1;                ///< that held when it was saved, 1 to 1000
  bool operator==(const LayerHead&) const = default;
};

struct SavedLayer {
  LayerHead head;
  BrickMap bricks;  ///< in the agent's own frame
};

struct MapArchive {
  double resolution = 0.0;              ///< of all layers and voxels, metres
  std::vector<SavedLayer> layers;       ///< by ascending agent, each once
  std::vector<Correction> corrections;  ///< by ascending revision
  Bytes labels;                         ///< a section that is semantic's to read; empty: there is none
};

/// Writes a file section by section: of the layers nothing is kept but their bytes. Equal content has equal bytes,
/// however it came about. Whatever it writes can be read: what read_map_archive would refuse is refused here.
class MapArchiveWriter {
 public:
  /// @pre checked_resolution(resolution).
  explicit MapArchiveWriter(double resolution);
  MapArchiveWriter(MapArchiveWriter&&) noexcept;
  MapArchiveWriter& operator=(MapArchiveWriter&&) noexcept;
  MapArchiveWriter(const MapArchiveWriter&) = delete;
  MapArchiveWriter& operator=(const MapArchiveWriter&) = delete;
  ~MapArchiveWriter();

  /// @pre ids ascend from call to call.
  [[nodiscard]] Result<void> add(const LayerHead& head, const BrickMap& bricks);
  /// In the order of their revisions. Of a zone's author, time and revision those of the correction are taken.
  [[nodiscard]] Result<void> add(const Correction& correction);
  /// The labels, as semantic wrote them. @pre not empty; called once at most.
  void add_labels(ByteSpan section);
  /// The whole file. Refused: kTooLarge.
  [[nodiscard]] Result<Bytes> finish() &&;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct MapArchiveOptions {
  std::optional<double> resolution = std::nullopt;  ///< the only one that is taken; absent: any
  std::uint64_t known_voxels = 400'000'000;         ///< of a layer
  bool keep_bricks = true;                          ///< false: bricks are checked like everything else, and dropped
};

/// Reads and checks a whole file. All of it is good or all of it is refused: damaged, cut short, foreign or of a newer
/// version, or saying what nobody could have saved (kMalformed); another resolution (kBadResolution); over a cap
/// (kTooLarge), found out before memory is taken. Sections that are unknown are passed over.
///
/// Corrections are what CorrectionCheck (core/correction_check.hpp) takes.
[[nodiscard]] Result<MapArchive> read_map_archive(ByteSpan file, const MapArchiveOptions& options = {});

/// Incarnations of agents that were loaded are this or greater; those that are counted by time are less.
inline constexpr std::int64_t kLoadedIncarnation = std::int64_t{1} << 62;

/// The section of the labels alone, of a file whose other sections somebody else looks at; empty: it has none. Refused:
/// as by read_map_archive, for that much.
[[nodiscard]] Result<Bytes> labels_of_map_archive(ByteSpan file);

/// What all agents that a request loads from a file have as their incarnation. Whoever reads the same file for the same
/// request computes the same: kLoadedIncarnation plus the low 62 bits of XXH3_64bits_withSeed(request id,
/// XXH3_64bits(file)).
[[nodiscard]] std::int64_t loaded_incarnation(ByteSpan file, std::string_view request_id);

}  // namespace concord
