#pragma once

#include <filesystem>
#include <string>

namespace concord {

/// The folder in which semantic lays the labels for merge to put into the map file that a request asks for: what is too
/// much for the bus. Semantic owns it: writes the file before merge may look, and takes it away after merge's answer.
[[nodiscard]] inline std::filesystem::path handover_folder(const std::filesystem::path& state) {
  return state / "handover";
}

/// @param request_id is_request_id; any such makes a name.
[[nodiscard]] inline std::filesystem::path handover_file(const std::filesystem::path& state,
                                                         const std::string& request_id) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string name;
  for (const char c : request_id) {
    const auto byte = static_cast<unsigned char>(c);
    name += kDigits[byte / 16];
    name += kDigits[byte % 16];
  }
  return handover_folder(state) / name;
}

}  // namespace concord
