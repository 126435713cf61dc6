#include "semantic/models/triangle_mesh.hpp"

#include <bit>
#include <cstring>

namespace concord {
namespace {

constexpr std::size_t kHeadBytes = 16, kVertexBytes = 24, kTriangleBytes = 12;

}  // namespace

Result<void> check(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return refuse(Code::kEmpty, "the model has no triangle");
  if (mesh.triangles.size() > kMaxModelTriangles || mesh.vertices.size() > 3 * kMaxModelTriangles) {
    return refuse(Code::kTooLarge,
                  "the model has over " + std::to_string(kMaxModelTriangles) + " triangles; simplify it");
  }
  for (const Eigen::Vector3d& p : mesh.vertices) {
    if (!p.allFinite()) return refuse(Code::kNotFinite, "a corner of the model is no number");
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= mesh.vertices.size()) return refuse(Code::kMalformed, "a triangle has a corner that is not there");
    }
  }
  return {};
}

static_assert(std::endian::native == std::endian::little, "the way between two processes copies memory");

Bytes to_bytes(const TriangleMesh& mesh) {
  Bytes out;
  out.reserve(kHeadBytes + kVertexBytes * mesh.vertices.size() + kTriangleBytes * mesh.triangles.size());
  append_le(out, static_cast<std::uint64_t>(mesh.vertices.size()));
  append_le(out, static_cast<std::uint64_t>(mesh.triangles.size()));
  const auto append = [&](const auto& values) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(values.data());
    out.insert(out.end(), bytes, bytes + values.size() * sizeof(values[0]));
  };
  append(mesh.vertices);
  append(mesh.triangles);
  return out;
}

Result<TriangleMesh> mesh_from_bytes(ByteSpan bytes) {
  const auto vertices = read_le<std::uint64_t>(bytes);
  const auto triangles = read_le<std::uint64_t>(bytes);
  if (!vertices || !triangles || *vertices > 3 * kMaxModelTriangles || *triangles > kMaxModelTriangles ||
      bytes.size() != *vertices * kVertexBytes + *triangles * kTriangleBytes) {
    return refuse(Code::kMalformed, "these bytes are no mesh");
  }
  TriangleMesh mesh;
  mesh.vertices.resize(*vertices);
  mesh.triangles.resize(*triangles);
  if (*vertices > 0) std::memcpy(mesh.vertices.data()->data(), bytes.data(), *vertices * kVertexBytes);
  bytes = bytes.subspan(*vertices * kVertexBytes);
  if (*triangles > 0) std::memcpy(mesh.triangles.data(), bytes.data(), *triangles * kTriangleBytes);
  if (const auto fine = check(mesh); !fine) return tl::unexpected(fine.error());
  return mesh;
}

}  // namespace concord
