#pragma once

#include <filesystem>
#include <functional>
#include <span>

#include "core/corrections.hpp"
#include "store/database.hpp"

namespace concord {

/// Refuses (kIo): the file says what nobody could have stored.
[[nodiscard]] tl::unexpected<Error> damaged(const std::string& what);

/// What people made, on disk before it is acknowledged: their corrections in the order of revisions.
class MergeStore {
 public:
  /// Opens or creates `file`; brings one of an earlier version up to this one. Edits count in voxels, so a store
  /// belongs to one resolution.
  /// @throws std::runtime_error if it cannot be opened, ConfigError if it was made for another resolution.
  MergeStore(const std::filesystem::path& file, double resolution);

  /// All of it or nothing, synced once. Refused (kIo): a full disk, say; nothing has changed then, and the next one
  /// may succeed. @pre their revisions and ids are new.
  [[nodiscard]] Result<void> put(std::span<const Correction> corrections);

  /// Hands on each correction above revision `after`, in the order of revisions, until one is refused. Refused: the
  /// file was damaged (kIo), and what `visit` refuses.
  [[nodiscard]] Result<void> for_each(const std::function<Result<void>(Correction)>& visit, std::int64_t after = 0);

 private:
  struct PutDetail;
  struct Readers;

  [[nodiscard]] Result<void> put_one(const Correction& correction);

  Database database_;
  Statement put_correction_, put_edit_, put_zone_, put_placement_, put_weight_;
};

}  // namespace concord
