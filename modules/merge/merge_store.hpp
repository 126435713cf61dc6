#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/requests.hpp"
#include "store/database.hpp"

namespace concord {

/// What people made, on disk before it is acknowledged: transforms by agent and frame, and edits in their order.
class MergeStore {
 public:
  /// Opens or creates `file`. Edits count in voxels, so a store belongs to one resolution.
  /// @throws std::runtime_error if it cannot be opened, ConfigError if it was made for another resolution.
  MergeStore(const std::filesystem::path& file, double resolution);

  /// Where an agent lies. It holds for one frame of one incarnation (see stream.md): what was removed and comes again
  /// is not what was placed.
  struct Placed {
    std::string agent;
    std::string frame_id;
    std::int64_t incarnation = 0;
    bool has_layer = false;  ///< false: it had sent poses only
    Transform T_map_agent = Transform::Identity();
  };
  [[nodiscard]] Result<void> put_transform(const Placed& placed, const std::string& author, std::int64_t utime);
  [[nodiscard]] Result<void> put_edit(const EditRequest& edit);

  [[nodiscard]] Result<std::vector<Placed>> transforms();
  /// Hands on each edit in the order in which they were put.
  [[nodiscard]] Result<void> for_each_edit(const std::function<void(const EditRequest&)>& visit);

 private:
  void check_resolution(double resolution);

  Database database_;
  Statement put_transform_;
  Statement put_edit_;
};

}  // namespace concord
