#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "core/error.hpp"

namespace concord::hmd {

/// The files that are served, read whole at the start: a request can name one of these and nothing else, so no path
/// ever reaches the file system. Models of assets come and go: these are found when they are asked for, by a plain name
/// in one folder, and read while they are sent.
class StaticFiles {
 public:
  static constexpr std::size_t kMaxBytes = 256 << 20;
  static constexpr std::size_t kMaxFiles = 10'000;
  static constexpr std::size_t kMaxModelBytes = 64 << 20;

  struct File {
    std::string type;
    std::shared_ptr<const std::string> body;  ///< null: it is on disk
    std::filesystem::path path = {};          ///< there
  };

  /// Adds all files below `folder` as `prefix` and their path there; names that are hidden or hold other letters than
  /// A-Z a-z 0-9 . _ - are left out. Refused: no such folder (kNotFound), over the limits (kTooLarge), unreadable
  /// (kIo).
  [[nodiscard]] Result<void> add(const std::filesystem::path& folder, const std::string& prefix);
  void add(const std::string& path, File file) { files_[path] = std::make_shared<const File>(std::move(file)); }

  /// From now on `prefix` and a plain name that ends in .glb name the file of `folder` that is called so then.
  void serve_models(const std::string& prefix, const std::filesystem::path& folder) {
    models_prefix_ = prefix;
    models_ = folder;
  }

  /// What a request target names; "/" is "/index.html", a query is not heeded. Null: nothing.
  [[nodiscard]] std::shared_ptr<const File> find(std::string_view target) const;
  [[nodiscard]] std::size_t size() const { return files_.size(); }

 private:
  [[nodiscard]] std::shared_ptr<const File> model(std::string_view name) const;

  std::map<std::string, std::shared_ptr<const File>, std::less<>> files_;
  std::string models_prefix_;  ///< empty: there are none
  std::filesystem::path models_;
  std::size_t bytes_ = 0;
};

}  // namespace concord::hmd
