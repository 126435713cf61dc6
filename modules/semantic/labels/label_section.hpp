#pragma once

#include <vector>

#include "core/byte_stream.hpp"
#include "core/error.hpp"
#include "core/label_corrections.hpp"

namespace concord {

/// Label corrections as bytes: core/map_archive.md says which. In a map file they stand one after the other; on disk
/// each is a row.

void append_label_correction(Bytes& out, const LabelCorrection& correction);

/// Takes the next off the front of `in`, not checked but for its bytes. Refused: what nobody wrote (kMalformed), over
/// `most` voxels (kTooLarge).
[[nodiscard]] Result<LabelCorrection> read_label_correction(ByteSpan& in, std::int64_t most = kMaxLabelVoxels);

/// Of one file: what people made, and what was taken back of that because merge refused it.
inline constexpr std::size_t kMaxReadCorrections = 2 * kMaxLabelCorrections;

/// A whole section: corrections that may follow one another (Labels::follows). Refused also: over
/// kMaxReadCorrections or the caps of Labels (kTooLarge), before memory is taken for more.
[[nodiscard]] Result<std::vector<LabelCorrection>> read_label_section(ByteSpan section);

}  // namespace concord
