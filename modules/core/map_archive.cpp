#include "core/map_archive.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include <xxhash.h>

#include "core/correction_check.hpp"
#include "core/decimal.hpp"
#include "core/map_archive_parts.hpp"
#include "core/octomap_format.hpp"

namespace concord {
namespace archive {
namespace {

static_assert(kMaxArchivePins == kMaxPins, "what can be made can be saved");

tl::unexpected<Error> too_large(const std::string& what) {
  return refuse(Code::kTooLarge, "map file: over " + what + " in one file");
}

Error at_correction(const Correction& correction, Error error) {
  error.message = "correction " + std::to_string(correction.revision) + ": " + error.message;
  return error;
}

}  // namespace

Result<void> Room::take_layer(std::uint64_t its_bricks, std::uint64_t its_voxels) {
  if (layers == 0) return too_large(std::to_string(kMaxArchiveLayers) + " layers");
  if (its_bricks > bricks) return too_large(std::to_string(kMaxArchiveBricks) + " bricks");
  if (its_voxels > voxels) return too_large(std::to_string(kMaxArchiveVoxels) + " known voxels");
  --layers;
  bricks -= its_bricks;
  voxels -= its_voxels;
  return {};
}

Result<void> Room::take_correction(const Correction& correction) {
  if (corrections == 0) return too_large(std::to_string(kMaxArchiveCorrections) + " corrections");
  const auto* edit = std::get_if<Correction::Edit>(&correction.what);
  const std::uint64_t its_pins = edit != nullptr ? edit->added.size() + edit->deleted.size() : 0;
  if (its_pins > pins) return too_large(std::to_string(kMaxArchivePins) + " voxels pinned");
  --corrections;
  pins -= its_pins;
  return {};
}

}  // namespace archive

namespace {

using archive::FieldReader;
using archive::malformed;

std::string text_of(archive::Tag tag) { return {tag.begin(), tag.end()}; }

/// Takes the sections of a file in their order.
class Reader {
 public:
  explicit Reader(const MapArchiveOptions& options) : options_(options) {}

  /// Whether this was the last.
  Result<bool> take(const archive::Section& section) {
    const auto& [tag, version, content] = section;
    const bool is_known = tag == archive::kLattice || tag == archive::kLayer || tag == archive::kCorrections ||
                          tag == archive::kLabels || tag == archive::kEnd;
    if (is_known && version != archive::kVersion) {
      return malformed("its section " + text_of(tag) + " has version " + std::to_string(version) +
                       ", this program knows " + std::to_string(archive::kVersion) + "; run a newer one");
    }
    Result<void> taken;
    if (tag == archive::kLattice) taken = take_lattice(content);
    if (tag == archive::kLayer) taken = take_layer(content);
    if (tag == archive::kCorrections) taken = take_corrections(content);
    if (tag == archive::kLabels) taken = take_labels(content);
    if (tag == archive::kEnd) taken = take_end(content);
    if (!taken) return tl::unexpected(taken.error());
    ++sections_;
    return tag == archive::kEnd;
  }

  MapArchive result() && { return std::move(out_); }

 private:
  static tl::unexpected<Error> out_of_order(archive::Tag tag) {
    return malformed("its section " + text_of(tag) + " is not where it belongs; save it again");
  }

  Result<void> take_lattice(ByteSpan content) {
    if (out_.resolution != 0) return out_of_order(archive::kLattice);
    FieldReader in(content);
    const auto resolution = checked_resolution(in.real());
    if (!in.ok() || !in.rest().empty() || !resolution) return malformed("its resolution is none; save it again");
    if (options_.resolution && *resolution != *options_.resolution) {
      return refuse(Code::kBadResolution, "the map has voxels of " + decimal(*resolution) + " m, the site of " +
                                              decimal(*options_.resolution) + " m; save it as .ot and load that");
    }
    out_.resolution = *resolution;
    return {};
  }

  Result<void> take_layer(ByteSpan content) {
    if (out_.resolution == 0 || has_corrections_) return out_of_order(archive::kLayer);
    auto layer = archive::read_layer(content, options_, room_);
    if (!layer) return tl::unexpected(layer.error());
    if (!out_.layers.empty() && !(out_.layers.back().head.agent < layer->head.agent)) {
      return out_of_order(archive::kLayer);
    }
    out_.layers.push_back(std::move(*layer));
    return {};
  }

  Result<void> take_corrections(ByteSpan content) {
    if (out_.resolution == 0 || has_corrections_) return out_of_order(archive::kCorrections);
    has_corrections_ = true;
    CorrectionCheck check;
    for (FieldReader in(content); !in.rest().empty();) {
      auto correction = archive::read_correction(in, room_);
      if (!correction) return tl::unexpected(correction.error());
      if (auto fine = check.take(*correction); !fine) {
        return malformed(archive::at_correction(*correction, fine.error()).message);
      }
      out_.corrections.push_back(std::move(*correction));
    }
    return {};
  }

  Result<void> take_labels(ByteSpan content) {
    if (!has_corrections_ || !out_.labels.empty() || content.empty()) return out_of_order(archive::kLabels);
    out_.labels.assign(content.begin(), content.end());
    return {};
  }

  Result<void> take_end(ByteSpan content) const {
    FieldReader in(content);
    const auto sections = in.integer<std::uint64_t>();
    if (!in.ok() || !in.rest().empty() || sections != sections_ || !has_corrections_) {
      return malformed("sections of it are missing; copy it again");
    }
    return {};
  }

  MapArchiveOptions options_;
  archive::Room room_;
  std::uint64_t sections_ = 0;
  bool has_corrections_ = false;
  MapArchive out_;
};

}  // namespace

struct MapArchiveWriter::State {
  Bytes bytes;
  Bytes corrections;
  Bytes labels;
  std::uint64_t sections = 0;
  std::string last_agent;
  archive::Room room;
  CorrectionCheck check;

  /// `append()` writes what stands in it.
  template <class Append>
  void section(archive::Tag tag, Append append) {
    const std::size_t begin = archive::begin_section(bytes, tag);
    append();
    archive::end_section(bytes, begin);
    ++sections;
  }
};

MapArchiveWriter::MapArchiveWriter(double resolution) : state_(std::make_unique<State>()) {
  assert(checked_resolution(resolution));
  archive::append_file_head(state_->bytes);
  state_->section(archive::kLattice, [&] { archive::append_real(state_->bytes, resolution); });
}

MapArchiveWriter::MapArchiveWriter(MapArchiveWriter&&) noexcept = default;
MapArchiveWriter& MapArchiveWriter::operator=(MapArchiveWriter&&) noexcept = default;
MapArchiveWriter::~MapArchiveWriter() = default;

Result<void> MapArchiveWriter::add(const LayerHead& head, const BrickMap& bricks) {
  assert(state_->last_agent < head.agent);
  if (auto fine = archive::check(head); !fine) return fine;
  if (auto fits = state_->room.take_layer(bricks.brick_count(), bricks.known_count()); !fits) return fits;
  state_->last_agent = head.agent;
  state_->section(archive::kLayer, [&] { archive::append_layer(state_->bytes, head, bricks); });
  return {};
}

Result<void> MapArchiveWriter::add(const Correction& correction) {
  if (auto fits = state_->room.take_correction(correction); !fits) return fits;
  if (auto fine = state_->check.take(correction); !fine) {
    return tl::unexpected(archive::at_correction(correction, fine.error()));
  }
  archive::append_correction(state_->corrections, correction);
  return {};
}

void MapArchiveWriter::add_labels(ByteSpan section) {
  assert(!section.empty() && state_->labels.empty());
  state_->labels.assign(section.begin(), section.end());
}

Result<Bytes> MapArchiveWriter::finish() && {
  Bytes& bytes = state_->bytes;
  state_->section(archive::kCorrections,
                  [&] { bytes.insert(bytes.end(), state_->corrections.begin(), state_->corrections.end()); });
  if (const Bytes& labels = state_->labels; !labels.empty()) {
    state_->section(archive::kLabels, [&] { bytes.insert(bytes.end(), labels.begin(), labels.end()); });
  }
  state_->section(archive::kEnd, [&] { append_le(bytes, state_->sections); });
  if (bytes.size() > kMaxArchiveBytes) return archive::too_large(std::to_string(kMaxArchiveBytes) + " bytes");
  return std::move(bytes);
}

Result<MapArchive> read_map_archive(ByteSpan file, const MapArchiveOptions& options) {
  if (file.size() > kMaxArchiveBytes) return archive::too_large(std::to_string(kMaxArchiveBytes) + " bytes");
  if (auto fine = archive::take_file_head(file); !fine) return tl::unexpected(fine.error());
  Reader reader(options);
  for (bool is_last = false; !is_last;) {
    const auto section = archive::take_section(file);
    if (!section) return tl::unexpected(section.error());
    const auto taken = reader.take(*section);
    if (!taken) return tl::unexpected(taken.error());
    is_last = *taken;
  }
  if (!file.empty()) return malformed("there is more behind its end; copy it again");
  return std::move(reader).result();
}

Result<Bytes> labels_of_map_archive(ByteSpan file) {
  if (file.size() > kMaxArchiveBytes) return archive::too_large(std::to_string(kMaxArchiveBytes) + " bytes");
  if (auto fine = archive::take_file_head(file); !fine) return tl::unexpected(fine.error());
  for (Bytes labels;;) {
    const auto section = archive::take_section(file);
    if (!section) return tl::unexpected(section.error());
    if (section->tag == archive::kEnd) return labels;
    if (section->tag != archive::kLabels) continue;
    if (section->version != archive::kVersion) return malformed("its labels were saved by a newer program; run that");
    labels.assign(section->content.begin(), section->content.end());
  }
}

std::int64_t loaded_incarnation(ByteSpan file, std::string_view request_id) {
  const std::uint64_t of_file = XXH3_64bits(file.data(), file.size());
  const std::uint64_t hash = XXH3_64bits_withSeed(request_id.data(), request_id.size(), of_file);
  return kLoadedIncarnation | static_cast<std::int64_t>(hash & (kLoadedIncarnation - 1));
}

}  // namespace concord
