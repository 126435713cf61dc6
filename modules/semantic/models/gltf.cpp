#include "semantic/models/gltf.hpp"

#include <bit>
#include <cstdio>
#include <limits>
#include <string>

namespace concord {
namespace {

constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBinary = 0x004E4942;

std::string vector_text(const Eigen::Vector3f& p) {
  char out[64];
  std::snprintf(out, sizeof(out), "[%.9g,%.9g,%.9g]", p.x(), p.y(), p.z());
  return out;
}

void append_chunk(Bytes& out, std::uint32_t kind, const Bytes& content) {
  append_le(out, static_cast<std::uint32_t>(content.size()));
  append_le(out, kind);
  out.insert(out.end(), content.begin(), content.end());
}

}  // namespace

Bytes write_glb(const TriangleMesh& mesh, double scale) {
  Bytes binary;
  binary.reserve(12 * (mesh.vertices.size() + mesh.triangles.size()));
  Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::max()), high = -low;
  for (const Eigen::Vector3d& p : mesh.vertices) {
    const Eigen::Vector3f q = (scale * p).cast<float>();
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
    for (int i = 0; i < 3; ++i) append_le(binary, std::bit_cast<std::uint32_t>(q[i]));
  }
  const std::size_t corners = binary.size();
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) append_le(binary, corner);
  }
  const auto n = [](std::size_t number) { return std::to_string(number); };
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"buffers":[{"byteLength":)" +
      n(binary.size()) + R"(}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":)" + n(corners) +
      R"(,"target":34962},{"buffer":0,"byteOffset":)" + n(corners) + R"(,"byteLength":)" + n(binary.size() - corners) +
      R"(,"target":34963}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" + n(mesh.vertices.size()) +
      R"(,"type":"VEC3","min":)" + vector_text(low) + R"(,"max":)" + vector_text(high) +
      R"(},{"bufferView":1,"componentType":5125,"count":)" + n(3 * mesh.triangles.size()) + R"(,"type":"SCALAR"}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');

  Bytes out;
  const std::size_t size = 12 + 8 + json.size() + 8 + binary.size();
  append_le(out, kMagic);
  append_le(out, kVersion);
  append_le(out, static_cast<std::uint32_t>(size));
  append_chunk(out, kJson, Bytes(json.begin(), json.end()));
  append_chunk(out, kBinary, binary);
  return out;
}

}  // namespace concord
