#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/assets.hpp"
#include "core/error.hpp"

namespace concord {

/// The models of the asset folder as headsets load them: FOLDER/gltf/NAME.glb, in metres, in the axes of the model's
/// own file, so that a placement is one for these too.
class GltfStore {
 public:
  explicit GltfStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Bytes of the asset's file; 0 if there is none of the model as it is.
  [[nodiscard]] std::int64_t bytes_of(const Asset& asset) const;

  /// Of the box around the model along its file's axes, metres; 0 if it is not known of the model as it is.
  [[nodiscard]] Eigen::Vector3d size_of(const Asset& asset) const;

  /// Writes the first that is not there, or not of its model as it is; a model that cannot be read is not tried again
  /// until it changes. Takes as long as reading a model. Refused: what read_model_file refuses, and kIo.
  [[nodiscard]] Result<void> write_next(const std::map<std::string, Asset>& assets);

 private:
  /// What a file was made of.
  struct Source {
    std::filesystem::file_time_type written;
    double unit = 0;
    bool operator==(const Source&) const = default;
  };
  [[nodiscard]] std::filesystem::path file_of(const Asset& asset) const {
    return folder_ / "gltf" / (asset.name + ".glb");
  }
  struct Tried {
    Source source;
    Eigen::Vector3d size = Eigen::Vector3d::Zero();
  };
  [[nodiscard]] Source source_of(const Asset& asset) const;
  /// Null: not tried as it is.
  [[nodiscard]] const Tried* tried(const Asset& asset) const;

  std::filesystem::path folder_;
  std::map<std::string, Tried> tried_;  ///< since this start
};

}  // namespace concord
