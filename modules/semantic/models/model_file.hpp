#pragma once

#include <filesystem>

#include "semantic/models/child_work.hpp"
#include "semantic/models/triangle_mesh.hpp"

namespace concord {

/// Reads a model file in a process of its own (ChildWork). Siblings that the model names are read from its own folder
/// and those below it only. Refused: kNotFound, kIo, kTooLarge (file size, triangles, or the memory or time it took),
/// and read_model.
[[nodiscard]] Result<TriangleMesh> read_model_file(const std::filesystem::path& file);

/// The same in this very process, which a hostile file may crash: for work that is in one of its own already.
[[nodiscard]] Result<TriangleMesh> read_model_file_here(const std::filesystem::path& file);

}  // namespace concord
