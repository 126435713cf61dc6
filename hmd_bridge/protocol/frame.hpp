#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/byte_stream.hpp"
#include "core/error.hpp"
#include "core/lattice.hpp"
#include "core/transform.hpp"

namespace concord::hmd {

/// Binary frames, laid out in PROTOCOL.md.

inline constexpr std::size_t kFrameHeader = 24;
inline constexpr std::size_t kMaxBinaryBytes = 4 << 20;     ///< of one binary frame from a client
inline constexpr std::size_t kMaxInflatedBytes = 16 << 20;  ///< of its payload, and of one to a client
inline constexpr std::size_t kPointBytes = 12;              ///< of a points frame
inline constexpr int kLevels = 6;

enum class FrameKind : std::uint8_t {
  kBlock = 1,
  kForget = 2,
  kPoints = 3,
  kCells = 4,
  kLabels = 5,
  kMesh = 65,
  kVoxels = 66
};

struct FrameHead {
  FrameKind kind = FrameKind::kBlock;
  bool whole = false;
  int level = 0;
  std::uint32_t stream = 0;  ///< or a request's id
  std::uint32_t count = 0;
  std::int64_t revision = 0;  ///< or a sequence
};

/// 16 x 16 x 16 cells, a bit each: cell x + 16 y + 256 z is bit v % 8 of byte v / 8.
using ChunkBits = std::array<std::uint8_t, 512>;

/// 64 x 64 x 64 cells of one level.
struct BlockIndex {
  std::int32_t x = 0, y = 0, z = 0;
  auto operator<=>(const BlockIndex&) const = default;
};

/// What one frame says of a block.
struct BlockContent {
  BlockIndex block;
  std::uint64_t told = 0;         ///< chunks spoken of: bit x + 4 y + 16 z
  std::uint64_t filled = 0;       ///< those with any cell
  std::vector<ChunkBits> chunks;  ///< one for each bit of `filled`, lowest first
};

/// What a block's voxels are labelled.
struct LabelContent {
  struct Thing {
    std::uint32_t label = 0, instance = 0;
  };
  struct Run {
    std::uint32_t gap = 0, length = 0, thing = 0;
  };
  BlockIndex block;
  std::vector<Thing> things;
  std::vector<Run> runs;  ///< of voxels x + 64 y + 4096 z; the gap counts from the end of the run before
};

/// One mesh of a look; without vertices it is gone.
struct MeshPart {
  std::uint32_t number = 0;
  std::vector<Eigen::Vector3f> vertices;  ///< own frame, metres
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
struct MeshLook {
  Transform T_own_sensor = Transform::Identity();
  std::vector<MeshPart> parts;
};

struct VoxelChunk {
  VoxelIndex chunk;  ///< in chunks of 16
  ChunkBits occupied, free;
};
struct VoxelLook {
  double resolution = 0;
  double p_occupied = 0, p_free = 0;
  Transform T_own_sensor = Transform::Identity();
  std::vector<VoxelChunk> chunks;
};

/// Raw deflate (RFC 1951).
[[nodiscard]] Bytes deflate(ByteSpan bytes);
/// Refused: what is no deflate stream, or is not exactly `size` bytes (kMalformed). Takes no more memory than `size`.
[[nodiscard]] Result<Bytes> inflate(ByteSpan bytes, std::size_t size);

/// A whole frame; the payload is deflated if that makes it smaller.
[[nodiscard]] Bytes make_frame(const FrameHead& head, const Bytes& payload);

struct BinaryFrame {
  FrameHead head;
  Bytes payload;  ///< inflated
};
/// As it came: its payload is not looked into yet.
struct PackedFrame {
  FrameHead head;
  bool deflated = false;
  std::size_t size = 0;  ///< of the payload, inflated
  Bytes body;
};
/// Refused: no header (kMalformed), over kMaxInflatedBytes (kTooLarge), a payload that cannot be what the header says.
[[nodiscard]] Result<PackedFrame> read_packed(ByteSpan bytes);
/// Refused: a payload that is not what the header says (kMalformed).
[[nodiscard]] Result<BinaryFrame> unpack(PackedFrame packed);
/// Both.
[[nodiscard]] Result<BinaryFrame> read_frame(ByteSpan bytes);

[[nodiscard]] Bytes block_payload(const BlockContent& content);
[[nodiscard]] Result<BlockContent> read_block(const BinaryFrame& frame);
[[nodiscard]] Bytes forget_payload(const std::vector<BlockIndex>& blocks);
[[nodiscard]] Result<std::vector<BlockIndex>> read_forget(const BinaryFrame& frame);
[[nodiscard]] Bytes labels_payload(const LabelContent& content);
/// Refused: what is no labels frame's payload, byte by byte (kMalformed).
[[nodiscard]] Result<LabelContent> read_labels(const BinaryFrame& frame);
[[nodiscard]] Bytes points_payload(const std::vector<Eigen::Vector3f>& points);

/// Refused: more or less than the header says (kMalformed), over 1024 parts or 500,000 vertices or triangles
/// (kTooLarge), no number (kNotFinite), no rotation (kBadTransform), beyond 1 km (kOutOfBounds).
[[nodiscard]] Result<MeshLook> read_mesh(const BinaryFrame& frame);
/// Refused likewise; at most 4096 chunks.
[[nodiscard]] Result<VoxelLook> read_voxels(const BinaryFrame& frame);
/// For clients in C++, and for tests.
[[nodiscard]] Bytes mesh_payload(const MeshLook& look);
[[nodiscard]] Bytes voxels_payload(const VoxelLook& look);

}  // namespace concord::hmd
