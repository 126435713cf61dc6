#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/assets.hpp"
#include "core/error.hpp"
#include "semantic/models/child_work.hpp"
#include "semantic/models/model_file.hpp"

namespace concord {

/// The models of the asset folder as headsets load them: FOLDER/gltf/NAME.glb, in metres, in the axes of the model's
/// own file, so that a placement is one for these too. What each was made of stands in FOLDER/gltf/made.yaml, so that
/// it is not made again.
class GltfStore {
 public:
  static constexpr std::int64_t kPause = 30'000'000;  ///< microseconds

  explicit GltfStore(std::filesystem::path folder);

  /// Bytes of the asset's file; 0 if there is none of the model as it is.
  [[nodiscard]] std::int64_t bytes_of(const Asset& asset) const;

  /// Of the box around the model along its file's axes, metres; 0 if it is not known of the model as it is.
  [[nodiscard]] Eigen::Vector3d size_of(const Asset& asset) const;

  /// What a file is made of.
  struct Source {
    FileState file;
    double unit = 0;
    bool operator==(const Source&) const = default;
  };
  [[nodiscard]] Source source_of(const Asset& asset) const;

  /// The first that has none, or none of its model as it is. Not one that is no model, until it or what it names
  /// changes; nor for kPause one whose file or disk failed. @param now microseconds
  [[nodiscard]] const Asset* next(const std::map<std::string, Asset>& assets, std::int64_t now) const;
  /// Writes the file, in a process of its own. Refused: read_model_file, kIo.
  [[nodiscard]] ChildWork::Work work_for(const Asset& asset) const;
  /// What came of that. Refused: what it refused, and kIo, where what was made cannot be noted.
  [[nodiscard]] Result<void> note(const std::string& name, const Source& source, const Result<Bytes>& reply,
                                  std::int64_t now);
  /// Removes what was made of assets that are gone. Refused: kIo.
  [[nodiscard]] Result<void> keep_only(const std::map<std::string, Asset>& assets);

 private:
  struct Made {
    Source source;
    std::vector<FileState> siblings;  ///< that it names, be they there or not
    Eigen::Vector3d size = Eigen::Vector3d::Zero();
    bool is_readable = true;
  };
  [[nodiscard]] std::filesystem::path file_of(const std::string& name) const {
    return folder_ / "gltf" / (name + ".glb");
  }
  /// Null: not tried as it is.
  [[nodiscard]] const Made* made_of(const Asset& asset) const;
  void read_notes();
  [[nodiscard]] Result<void> write_notes() const;

  std::filesystem::path folder_;
  std::map<std::string, Made> made_;
  std::map<std::string, std::int64_t> failed_;  ///< by asset: when
};

}  // namespace concord
