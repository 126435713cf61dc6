#include "semantic/assets/asset_folder.hpp"

#include <cmath>

#include <yaml-cpp/yaml.h>

#include "core/text.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> bad(Code code, const std::string& what) { return refuse(code, "assets.yaml: " + what); }

Result<Asset> asset_of(const std::string& name, const YAML::Node& node) {
  if (!is_name(name)) return bad(Code::kBadName, "'" + name + "' is no name of an asset");
  Asset asset{name, name, "", 1.0, 0};
  for (const auto& entry : node) {
    const auto key = entry.first.as<std::string>();
    if (key == "file") {
      asset.file = entry.second.as<std::string>();
    } else if (key == "class") {
      asset.class_name = entry.second.as<std::string>();
    } else if (key == "unit") {
      asset.unit = entry.second.as<double>();
    } else {
      return bad(Code::kMalformed, name + " has an unknown key " + key);
    }
  }
  const bool plain = !asset.file.empty() && asset.file.size() <= 200 && fs::path(asset.file).filename() == asset.file &&
                     asset.file != "..";
  if (!plain) return bad(Code::kBadName, name + " needs a file in the same folder");
  if (!is_title(asset.class_name)) return bad(Code::kBadName, name + " has a class that is no name");
  if (!(asset.unit > 0) || !std::isfinite(asset.unit)) return bad(Code::kMalformed, name + " has a unit that is none");
  return asset;
}

Result<Asset> entry_of(const YAML::Node& key, const YAML::Node& node) {
  std::string name;
  try {
    name = key.as<std::string>();
    return asset_of(name, node);
  } catch (const YAML::Exception& e) {
    return bad(Code::kMalformed, name + ": " + e.what());
  }
}

}  // namespace

Result<AssetFolder> read_asset_folder(const fs::path& folder) {
  AssetFolder out;
  const fs::path file = folder / "assets.yaml";
  std::error_code error;
  if (!fs::exists(file, error)) return out;
  try {
    const YAML::Node all = YAML::LoadFile(file.string());
    if (all.IsNull()) return out;
    if (!all.IsMap()) return bad(Code::kMalformed, "must be a map of names");
    if (all.size() > kMaxAssets) return bad(Code::kTooLarge, "has over " + std::to_string(kMaxAssets) + " assets");
    for (const auto& entry : all) {
      auto asset = entry_of(entry.first, entry.second);
      if (asset) {
        out.assets[asset->name] = *asset;
      } else {
        out.bad.push_back(asset.error());
      }
    }
  } catch (const YAML::Exception& e) {
    return bad(Code::kMalformed, e.what());
  }
  return out;
}

}  // namespace concord
