#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/assets.hpp"
#include "core/error.hpp"

namespace concord {

/// Reads FOLDER/assets.yaml, a line for each model:
///
///     pallet: {file: pallet.glb, class: pallet, unit: 0.001}
///
/// `class` is the name and `unit` 1 (metres) where they are left out. No such file: no asset. Refused: anything else in
/// it (kMalformed), a name that is none or a file outside the folder (kBadName), over kMaxAssets (kTooLarge).
[[nodiscard]] Result<std::map<std::string, Asset>> read_asset_folder(const std::filesystem::path& folder);

}  // namespace concord
