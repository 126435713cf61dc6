#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <vector>

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
  /// All or none.
  [[nodiscard]] Result<void> put(std::span<const LabelCorrection> corrections);
  /// Where a frame lies from now on. Refused: kIo.
  [[nodiscard]] Result<void> put(const LabelAnchor& placed);
  /// So many numbers of things that nobody was given before, nor will be: the first. Refused: kIo.
  [[nodiscard]] Result<std::int64_t> take_thing_numbers(std::int64_t count);

  /// Whether this very deletion was asked for by this id before. Refused: another one was (kExists); kIo.
  [[nodiscard]] Result<bool> was_asked(const std::string& deletion_id, std::uint64_t content);
  /// Refused: kTooLarge, as many as label requests are kept; kIo.
  [[nodiscard]] Result<void> put_deletion(const std::string& id, std::uint64_t content);

  /// In the order of their revisions. Refused (kIo): the file is damaged; and what `visit` refuses.
  [[nodiscard]] Result<void> for_each(const std::function<Result<void>(LabelCorrection)>& visit);
  /// In the order of agents and frames. Refused likewise.
  [[nodiscard]] Result<std::vector<LabelAnchor>> placements();

 private:
  Database database_;
  Statement put_, place_, spend_, asked_, delete_;
  std::size_t deletions_ = 0;
};

}  // namespace concord
