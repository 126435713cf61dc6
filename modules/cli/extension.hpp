#pragma once

#include <algorithm>
#include <filesystem>
#include <string>

namespace concord {

/// ".bt" of both room.bt and ROOM.BT: cameras and some systems write capitals.
[[nodiscard]] inline std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return extension;
}

}  // namespace concord
