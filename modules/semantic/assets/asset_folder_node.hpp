#pragma once

#include <future>
#include <map>
#include <string>
#include <vector>

#include "bus/messages_asset.hpp"
#include "bus/process.hpp"
#include "semantic/assets/gltf_store.hpp"
#include "semantic/work_queue.hpp"

namespace concord {

/// The folder of models, looked at each second: says what is in it (`out/assets`), and has each made into glTF.
class AssetFolderNode {
 public:
  /// @param how deferred: a model is converted while the bus waits, so that on log time it takes none.
  AssetFolderNode(const NodeContext& context, std::launch how);
  AssetFolderNode(const AssetFolderNode&) = delete;
  AssetFolderNode& operator=(const AssetFolderNode&) = delete;

  [[nodiscard]] const std::map<std::string, Asset>& assets() const { return assets_; }

 private:
  void list();
  void write_gltf();

  NodeContext context_;
  WorkQueue conversions_;
  GltfStore gltf_;
  ListSender<Asset> list_;
  std::map<std::string, Asset> assets_;
  std::vector<Error> bad_entries_;  ///< of assets.yaml, as last counted
};

}  // namespace concord
