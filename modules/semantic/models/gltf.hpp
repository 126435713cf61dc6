#pragma once

#include "core/byte_stream.hpp"
#include "semantic/models/triangle_mesh.hpp"

namespace concord {

/// A model as binary glTF 2.0, one mesh of plain triangles: corners times `scale` as 32-bit floats, axes as they are.
/// @pre check(mesh); the file stays below 4 GB, which kMaxModelTriangles sees to.
[[nodiscard]] Bytes write_glb(const TriangleMesh& mesh, double scale);

}  // namespace concord
