#pragma once

#include <functional>
#include <string>

#include "semantic/models/triangle_mesh.hpp"

namespace concord {

/// Brings a file that a model names (the buffer of a `.gltf`), relative to the model's folder.
using SiblingReader = std::function<Result<Bytes>(const std::string& name)>;

/// The triangles of a model: glTF (`glb`, `gltf`), `obj`, `stl`, `ply`; all its parts, in their places. Axes and unit
/// stay the file's. Refused: another kind (kBadName), what the library cannot read (kMalformed), and `check`.
///
/// The library (assimp) was not written for hostile files: call it where a crash does no harm (model_file.hpp).
[[nodiscard]] Result<TriangleMesh> read_model(ByteSpan bytes, const std::string& kind, const SiblingReader& siblings);

/// Whether `kind`, a file's extension in lower case without the dot, is one that read_model takes.
[[nodiscard]] bool is_model_kind(const std::string& kind);

}  // namespace concord
