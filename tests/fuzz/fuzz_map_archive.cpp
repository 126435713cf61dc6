#include <algorithm>
#include <array>
#include <utility>

#include "core/map_archive.hpp"
#include "core/map_archive_sections.hpp"
#include "must.hpp"

using namespace concord;

namespace {

/// Small, so that what a few bytes may ask for stays within the fuzzer's memory and time.
constexpr std::uint64_t kFewVoxels = 1 << 20;

Bytes write(const MapArchive& map) {
  MapArchiveWriter writer(map.resolution);
  for (const SavedLayer& layer : map.layers) fuzz::must(writer.add(layer.head, layer.bricks).has_value());
  for (const Correction& correction : map.corrections) fuzz::must(writer.add(correction).has_value());
  const Result<Bytes> file = std::move(writer).finish();
  fuzz::must(file.has_value());
  return *file;
}

/// A map that was taken is written, is read again, and then has the same bytes for good.
void check_map(ByteSpan file) {
  const auto read = read_map_archive(file, {.resolution = {}, .known_voxels = kFewVoxels});
  const auto checked = read_map_archive(file, {.resolution = {}, .known_voxels = kFewVoxels, .keep_bricks = false});
  fuzz::must(read.has_value() == checked.has_value());
  if (!read) return;
  const Bytes written = write(*read);
  const auto again = read_map_archive(written);
  fuzz::must(again.has_value());
  fuzz::must(write(*again) == written);
  fuzz::must(written.size() <= file.size());
}

/// Sections whose frames are right, whatever stands in them: tag, length and content of each from the input.
Bytes framed(ByteSpan in) {
  constexpr std::array kTags{archive::kLattice, archive::kLayer, archive::kCorrections,
                             archive::Tag{'N', 'E', 'W', '.'}};
  Bytes file;
  archive::append_file_head(file);
  std::uint64_t sections = 0;
  const auto append = [&](archive::Tag tag, ByteSpan content) {
    const std::size_t begin = archive::begin_section(file, tag);
    file.insert(file.end(), content.begin(), content.end());
    archive::end_section(file, begin);
    ++sections;
  };
  Bytes lattice;
  archive::append_real(lattice, 0.05);
  append(archive::kLattice, lattice);
  while (const auto tag = read_le<std::uint8_t>(in)) {
    const std::size_t length = std::min<std::size_t>(read_le<std::uint16_t>(in).value_or(0), in.size());
    append(kTags[*tag % kTags.size()], in.first(length));
    in = in.subspan(length);
  }
  Bytes count;
  append_le(count, sections);
  append(archive::kEnd, count);
  return file;
}

}  // namespace

/// A file as it stands, or (first byte odd) the contents of sections.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const ByteSpan in(data + 1, size - 1);
  if ((data[0] & 1) != 0) {
    check_map(framed(in));
  } else {
    check_map(in);
  }
  return 0;
}
