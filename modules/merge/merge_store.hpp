#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/requests.hpp"
#include "store/database.hpp"

namespace concord {

/// What people made, on disk before it is acknowledged: transforms by agent and frame, and edits in their order.
class MergeStore {
 public:
  /// Opens or creates `file`. Edits count in voxels, so a store belongs to one resolution.
  /// @throws std::runtime_error if it cannot be opened or was made for another resolution.
  MergeStore(const std::filesystem::path& file, double resolution);

  [[nodiscard]] Result<void> put_transform(const TransformRequest& request, std::int64_t utime);
  [[nodiscard]] Result<void> forget_agent(const std::string& agent);
  [[nodiscard]] Result<void> put_edit(const EditRequest& edit);

  struct Placed {
    std::string agent;
    std::string frame_id;
    Transform T_map_agent;
  };
  [[nodiscard]] Result<std::vector<Placed>> transforms();
  /// In the order in which they were put.
  [[nodiscard]] Result<std::vector<EditRequest>> edits();

 private:
  void check_resolution(double resolution);

  Database database_;
  Statement put_transform_;
  Statement forget_agent_;
  Statement put_edit_;
};

}  // namespace concord
