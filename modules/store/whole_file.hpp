#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "core/byte_stream.hpp"
#include "core/error.hpp"

namespace concord {

/// Reads a file of at most `most` bytes. Refused: kNotFound, kTooLarge (before memory is taken), kIo.
[[nodiscard]] Result<Bytes> read_whole_file(const std::filesystem::path& file, std::uint64_t most);

/// Replaces a file as a whole: written beside it, synced, renamed, and the folder synced. After a crash at any moment
/// the file is the old or the new one. Refused (kIo) with what the system says.
[[nodiscard]] Result<void> write_whole_file(const std::filesystem::path& file, ByteSpan bytes);

struct FileToWrite {
  std::filesystem::path path;
  ByteSpan bytes;
};

/// The same of several files in one folder: none is touched before all are written beside and synced. A crash or
/// a fault of the disk between the renames leaves some old and some new, each whole.
[[nodiscard]] Result<void> write_whole_files(std::span<const FileToWrite> files);

}  // namespace concord
