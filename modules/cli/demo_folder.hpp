#pragma once

#include <filesystem>
#include <vector>

#include "cli/file_lock.hpp"
#include "core/error.hpp"

namespace concord {

/// The folder a demo writes to, and what it writes there.
struct DemoFolder {
  std::filesystem::path path;

  [[nodiscard]] std::filesystem::path state() const { return path / "demo_state"; }
  [[nodiscard]] std::filesystem::path output() const { return path / "demo_output"; }  ///< what the processes print
  [[nodiscard]] std::filesystem::path log() const { return path / "demo.lcm"; }
  [[nodiscard]] std::filesystem::path map() const { return path / "map.bt"; }
  [[nodiscard]] std::filesystem::path site() const { return path / "site.yaml"; }

  /// Makes it, without what an earlier demo wrote there; other things may lie in it and stay.
  /// @return what keeps other demos off it.
  /// Refused, with nothing touched: a demo that runs there (kBusy), files of such names that no demo wrote (kExists),
  /// one of `inputs` that would be written over (kBadRequest). Refused: kIo.
  [[nodiscard]] Result<FileLock> prepare(const std::vector<std::filesystem::path>& inputs) const;
};

}  // namespace concord
