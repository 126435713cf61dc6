#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/assets.hpp"
#include "core/error.hpp"

namespace concord {

/// Reads FOLDER/assets.yaml, a line for each model:
///
///     pallet: {file: pallet.glb, class: pallet, unit: 0.001}
///
/// `class` is the name and `unit` 1 (metres) where they are left out. No such file: no asset.
struct AssetFolder {
  std::map<std::string, Asset> assets;
  /// Of entries that are none, and are left out: unknown keys, values that are none (kMalformed), a name that is none
  /// or a file outside the folder (kBadName).
  std::vector<Error> bad;
};
/// Refused: what is no map of names (kMalformed), over kMaxAssets (kTooLarge).
[[nodiscard]] Result<AssetFolder> read_asset_folder(const std::filesystem::path& folder);

}  // namespace concord
