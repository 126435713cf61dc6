#pragma once

#include <filesystem>
#include <functional>

#include "core/label_corrections.hpp"
#include "store/database.hpp"

namespace concord {

/// What people labelled, on disk: each correction before it is answered.
class SemanticStore {
 public:
  /// @throws std::runtime_error if the file cannot be used; ConfigError if its labels are for another resolution.
  SemanticStore(const std::filesystem::path& file, double resolution);

  /// Refused: kIo; nothing was stored then.
  [[nodiscard]] Result<void> put(const LabelCorrection& correction);

  /// In the order of their revisions. Refused (kIo): the file is damaged; and what `visit` refuses.
  [[nodiscard]] Result<void> for_each(const std::function<Result<void>(LabelCorrection)>& visit);

 private:
  void check_resolution(double resolution);

  Database database_;
  Statement put_;
};

}  // namespace concord
