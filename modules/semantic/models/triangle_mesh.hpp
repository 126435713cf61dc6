#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/byte_stream.hpp"
#include "core/error.hpp"

namespace concord {

/// Of one model: caps that hold before memory is taken for what is beyond them.
inline constexpr std::size_t kMaxModelBytes = 400'000'000;
inline constexpr std::size_t kMaxModelTriangles = 10'000'000;

/// A model's triangles in the frame and unit of its file.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `vertices`
};

/// Whether a mesh can be worked with. Refused: no triangle (kEmpty), over the caps (kTooLarge), an index that is none
/// (kMalformed), a coordinate that is no number (kNotFinite).
[[nodiscard]] Result<void> check(const TriangleMesh& mesh);

/// The mesh as bytes and back, for the way between two processes (model_file.hpp). Refused: kMalformed, and `check`.
[[nodiscard]] Bytes to_bytes(const TriangleMesh& mesh);
[[nodiscard]] Result<TriangleMesh> mesh_from_bytes(ByteSpan bytes);

}  // namespace concord
