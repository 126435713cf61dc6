#include <algorithm>
#include <cmath>
#include <cstring>

#include "protocol/frame.hpp"

namespace concord::hmd {
namespace {

constexpr std::uint32_t kMaxParts = 1024;
constexpr std::uint32_t kMaxChunks = 4096;
constexpr std::uint32_t kMaxCorners = 500'000;
constexpr float kMaxReach = 1000;  // metres

tl::unexpected<Error> early() { return refuse(Code::kMalformed, "the payload ends early or late"); }

void append_float(Bytes& out, float value) { append_le(out, std::bit_cast<std::uint32_t>(value)); }
std::optional<float> read_float(ByteSpan& in) {
  const auto bits = read_le<std::uint32_t>(in);
  if (!bits) return std::nullopt;
  return std::bit_cast<float>(*bits);
}

void append_pose(Bytes& out, const Transform& T) {
  const Eigen::Quaterniond q(T.linear());
  for (int i = 0; i < 3; ++i) append_float(out, static_cast<float>(T.translation()[i]));
  for (const double part : {q.x(), q.y(), q.z(), q.w()}) append_float(out, static_cast<float>(part));
}

Result<Transform> read_pose(ByteSpan& in) {
  std::array<double, 7> v;
  for (double& part : v) {
    const auto value = read_float(in);
    if (!value) return early();
    part = *value;
  }
  if (std::abs(v[0]) > kMaxReach || std::abs(v[1]) > kMaxReach || std::abs(v[2]) > kMaxReach) {
    return refuse(Code::kOutOfBounds, "the sensor is over 1 km from the frame's origin");
  }
  return make_transform({v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]});
}

template <class Index>
void append_index(Bytes& out, const Index& index) {
  append_le(out, index.x);
  append_le(out, index.y);
  append_le(out, index.z);
}
/// @pre `in` holds 12 bytes.
template <class Index>
Index take_index(ByteSpan& in) {
  Index index;
  index.x = *read_le<std::int32_t>(in);
  index.y = *read_le<std::int32_t>(in);
  index.z = *read_le<std::int32_t>(in);
  return index;
}

/// @pre `in` holds as many.
ChunkBits take_bits(ByteSpan& in) {
  ChunkBits bits;
  std::memcpy(bits.data(), in.data(), bits.size());
  in = in.subspan(bits.size());
  return bits;
}

Result<MeshPart> read_part(ByteSpan& in) {
  if (in.size() < 12) return early();
  MeshPart part;
  part.number = *read_le<std::uint32_t>(in);
  const auto vertices = *read_le<std::uint32_t>(in);
  const auto triangles = *read_le<std::uint32_t>(in);
  if (vertices > kMaxCorners || triangles > kMaxCorners)
    return refuse(Code::kTooLarge, "a mesh has at most 500,000 vertices and triangles");
  if (in.size() < (std::size_t{vertices} + triangles) * 12) return early();
  part.vertices.reserve(vertices);
  for (std::uint32_t i = 0; i < vertices; ++i) {
    Eigen::Vector3f p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = *read_float(in);
    if (!p.allFinite()) return refuse(Code::kNotFinite, "a vertex is no number");
    if (p.cwiseAbs().maxCoeff() > kMaxReach)
      return refuse(Code::kOutOfBounds, "a vertex is over 1 km from the frame's origin");
    part.vertices.push_back(p);
  }
  part.triangles.reserve(triangles);
  for (std::uint32_t i = 0; i < triangles; ++i) {
    std::array<std::uint32_t, 3> corners;
    for (std::uint32_t& corner : corners) {
      corner = *read_le<std::uint32_t>(in);
      if (corner >= vertices) return refuse(Code::kMalformed, "a triangle has a corner that is none");
    }
    part.triangles.push_back(corners);
  }
  return part;
}

}  // namespace

Bytes block_payload(const BlockContent& content) {
  Bytes out;
  out.reserve(28 + content.chunks.size() * sizeof(ChunkBits));
  append_index(out, content.block);
  append_le(out, content.told);
  append_le(out, content.filled);
  for (const ChunkBits& bits : content.chunks) out.insert(out.end(), bits.begin(), bits.end());
  return out;
}

Result<BlockContent> read_block(const BinaryFrame& frame) {
  ByteSpan in = frame.payload;
  if (in.size() < 28) return early();
  BlockContent content;
  content.block = take_index<BlockIndex>(in);
  content.told = *read_le<std::uint64_t>(in);
  content.filled = *read_le<std::uint64_t>(in);
  if ((content.filled & ~content.told) != 0) return refuse(Code::kMalformed, "chunks that are filled but not told");
  const std::size_t chunks = static_cast<std::size_t>(std::popcount(content.filled));
  if (chunks != frame.head.count || in.size() != chunks * sizeof(ChunkBits)) return early();
  for (std::size_t i = 0; i < chunks; ++i) content.chunks.push_back(take_bits(in));
  return content;
}

Bytes forget_payload(const std::vector<BlockIndex>& blocks) {
  Bytes out;
  for (const BlockIndex& block : blocks) append_index(out, block);
  return out;
}

Result<std::vector<BlockIndex>> read_forget(const BinaryFrame& frame) {
  ByteSpan in = frame.payload;
  if (in.size() != std::size_t{frame.head.count} * 12) return early();
  std::vector<BlockIndex> blocks;
  while (!in.empty()) blocks.push_back(take_index<BlockIndex>(in));
  return blocks;
}

Bytes points_payload(const std::vector<Eigen::Vector3f>& points) {
  Bytes out;
  out.reserve(points.size() * kPointBytes);
  for (const Eigen::Vector3f& p : points) {
    for (int axis = 0; axis < 3; ++axis) append_float(out, p[axis]);
  }
  return out;
}

Bytes labels_payload(const LabelContent& content) {
  Bytes out;
  append_index(out, content.block);
  append_le(out, static_cast<std::uint32_t>(content.things.size()));
  for (const LabelContent::Thing& thing : content.things) {
    append_le(out, thing.label);
    append_le(out, thing.instance);
  }
  append_le(out, static_cast<std::uint32_t>(content.runs.size()));
  for (const LabelContent::Run& run : content.runs) {
    for (const std::uint32_t part : {run.gap, run.length, run.thing}) append_varint(out, part);
  }
  return out;
}

Result<LabelContent> read_labels(const BinaryFrame& frame) {
  ByteSpan in = frame.payload;
  LabelContent content;
  if (in.size() < 16) return early();
  content.block = take_index<BlockIndex>(in);
  const std::uint32_t things = *read_le<std::uint32_t>(in);
  if (things != frame.head.count || in.size() / 8 < things) return early();
  for (std::uint32_t i = 0; i < things; ++i) {
    content.things.push_back({*read_le<std::uint32_t>(in), *read_le<std::uint32_t>(in)});
  }
  const auto runs = read_le<std::uint32_t>(in);
  if (!runs || in.size() / 3 < *runs) return early();
  std::uint64_t at = 0;
  for (std::uint32_t i = 0; i < *runs; ++i) {
    const auto gap = read_varint(in), length = read_varint(in), thing = read_varint(in);
    if (!gap || !length || !thing) return early();
    const bool fits = *gap <= 64 * 64 * 64 && *length > 0 && *length <= 64 * 64 * 64 && *thing < things;
    if (!fits || (at += *gap + *length) > 64 * 64 * 64) return refuse(Code::kMalformed, "a run that cannot be");
    content.runs.push_back(
        {static_cast<std::uint32_t>(*gap), static_cast<std::uint32_t>(*length), static_cast<std::uint32_t>(*thing)});
  }
  if (!in.empty()) return early();
  return content;
}

Result<MeshLook> read_mesh(const BinaryFrame& frame) {
  if (frame.head.count > kMaxParts) return refuse(Code::kTooLarge, "a look has at most 1024 meshes");
  ByteSpan in = frame.payload;
  MeshLook look;
  auto pose = read_pose(in);
  if (!pose) return tl::unexpected(std::move(pose.error()));
  look.T_own_sensor = *pose;
  for (std::uint32_t i = 0; i < frame.head.count; ++i) {
    auto part = read_part(in);
    if (!part) return tl::unexpected(std::move(part.error()));
    look.parts.push_back(std::move(*part));
  }
  if (!in.empty()) return early();
  return look;
}

Result<VoxelLook> read_voxels(const BinaryFrame& frame) {
  if (frame.head.count > kMaxChunks) return refuse(Code::kTooLarge, "a look has at most 4096 chunks");
  ByteSpan in = frame.payload;
  if (in.size() < 16) return early();
  VoxelLook look;
  look.resolution = std::bit_cast<double>(*read_le<std::uint64_t>(in));
  look.p_occupied = *read_float(in);
  look.p_free = *read_float(in);
  if (!std::isfinite(look.resolution)) return refuse(Code::kNotFinite, "the resolution is not finite");
  if (!(look.p_occupied > 0.5 && look.p_occupied < 1) || !(look.p_free > 0 && look.p_free < 0.5)) {
    return refuse(Code::kNotFinite,
                  "the probability of occupied lies above a half, that of free below, both within 0 and 1");
  }
  auto pose = read_pose(in);
  if (!pose) return tl::unexpected(std::move(pose.error()));
  look.T_own_sensor = *pose;
  constexpr std::size_t kEach = 12 + 2 * sizeof(ChunkBits);
  if (in.size() != std::size_t{frame.head.count} * kEach) return early();
  look.chunks.reserve(frame.head.count);
  while (!in.empty()) {
    VoxelChunk& chunk = look.chunks.emplace_back();
    chunk.chunk = take_index<VoxelIndex>(in);
    constexpr std::int32_t kMost = kMaxVoxel / 16;
    for (const std::int32_t i : {chunk.chunk.x, chunk.chunk.y, chunk.chunk.z}) {
      if (i < -kMost || i >= kMost) return refuse(Code::kOutOfBounds, "a chunk beyond any map");
    }
    chunk.occupied = take_bits(in);
    chunk.free = take_bits(in);
  }
  return look;
}

Bytes mesh_payload(const MeshLook& look) {
  Bytes out;
  append_pose(out, look.T_own_sensor);
  for (const MeshPart& part : look.parts) {
    append_le(out, part.number);
    append_le(out, static_cast<std::uint32_t>(part.vertices.size()));
    append_le(out, static_cast<std::uint32_t>(part.triangles.size()));
    for (const Eigen::Vector3f& p : part.vertices) {
      for (int axis = 0; axis < 3; ++axis) append_float(out, p[axis]);
    }
    for (const auto& corners : part.triangles) {
      for (const std::uint32_t corner : corners) append_le(out, corner);
    }
  }
  return out;
}

Bytes voxels_payload(const VoxelLook& look) {
  Bytes out;
  append_le(out, std::bit_cast<std::uint64_t>(look.resolution));
  append_float(out, static_cast<float>(look.p_occupied));
  append_float(out, static_cast<float>(look.p_free));
  append_pose(out, look.T_own_sensor);
  for (const VoxelChunk& chunk : look.chunks) {
    append_index(out, chunk.chunk);
    out.insert(out.end(), chunk.occupied.begin(), chunk.occupied.end());
    out.insert(out.end(), chunk.free.begin(), chunk.free.end());
  }
  return out;
}

}  // namespace concord::hmd
