#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "core/error.hpp"

namespace concord {

/// A file that one program holds at a time. The kernel frees it when that program ends, however it does; the file
/// stays.
class FileLock {
 public:
  /// Makes the file and its folder where they are missing. Refused: another program holds it (kBusy, with `held` as the
  /// message), kIo.
  [[nodiscard]] static Result<FileLock> take(const std::filesystem::path& file, const std::string& held);

  FileLock(FileLock&& other) noexcept : handle_(std::exchange(other.handle_, -1)) {}
  FileLock& operator=(FileLock&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~FileLock();

 private:
  explicit FileLock(int handle) : handle_(handle) {}

  int handle_;
};

}  // namespace concord
