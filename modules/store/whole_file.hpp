#pragma once

#include <cstdint>
#include <filesystem>

#include "core/byte_stream.hpp"
#include "core/error.hpp"

namespace concord {

/// Reads a file of at most `most` bytes. Refused: kNotFound, kTooLarge (before memory is taken), kIo.
[[nodiscard]] Result<Bytes> read_whole_file(const std::filesystem::path& file, std::uint64_t most);

/// Replaces a file as a whole: written beside it, synced, renamed, and the folder synced. After a crash at any moment
/// the file is the old or the new one. Refused (kIo) with what the system says.
[[nodiscard]] Result<void> write_whole_file(const std::filesystem::path& file, ByteSpan bytes);

}  // namespace concord
