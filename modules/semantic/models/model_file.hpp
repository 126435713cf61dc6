#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "semantic/models/child_work.hpp"
#include "semantic/models/triangle_mesh.hpp"

namespace concord {

/// Reads a model file in a process of its own (ChildWork). Siblings that the model names are read from its own folder
/// and those below it only. Refused: kNotFound, kIo, kTooLarge (file size, triangles, or the memory or time it took),
/// and read_model.
[[nodiscard]] Result<TriangleMesh> read_model_file(const std::filesystem::path& file);

/// By which is seen whether a file is another than before.
struct FileState {
  std::string name;          ///< within its folder
  std::int64_t written = 0;  ///< by the file system's clock
  std::int64_t bytes = 0;    ///< 0 also of a file that is not there
  bool operator==(const FileState&) const = default;
};
[[nodiscard]] FileState state_of(const std::filesystem::path& folder, const std::string& name);

/// The same in this very process, which a hostile file may crash: for work that is in one of its own already.
/// @param siblings null, or where to add what it names besides, as it was before it was read; also if it is refused.
[[nodiscard]] Result<TriangleMesh> read_model_file_here(const std::filesystem::path& file,
                                                        std::vector<FileState>* siblings = nullptr);

}  // namespace concord
