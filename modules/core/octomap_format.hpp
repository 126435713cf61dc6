#pragma once

#include "core/byte_stream.hpp"
#include "core/error.hpp"
#include "core/lattice.hpp"

namespace concord {

/// The two ways in which OctoMap writes a tree; files have a text header before it, octomap_msgs payloads have none.
enum class OctomapFormat {
  kBinary,  ///< `.bt`, writeBinaryData: two bits a child, free or occupied
  kFull,    ///< `.ot`, writeData: a float of log-odds and a byte of children a node
};

/// An OctoMap is a tree of 16 levels under its root. Its key k on an axis is our voxel index k - 32768, at any
/// resolution.
inline constexpr int kOctomapDepth = 16;
inline constexpr std::int32_t kOctomapOrigin = -(1 << (kOctomapDepth - 1));

/// Resolutions that are taken from outside, metres.
inline constexpr double kMinResolution = 1e-4;
inline constexpr double kMaxResolution = 100.0;

/// Refused (kNotFinite, kBadResolution): what is not in [kMinResolution, kMaxResolution].
[[nodiscard]] Result<double> checked_resolution(double resolution);

struct OctomapHeader {
  OctomapFormat format = OctomapFormat::kBinary;
  std::uint64_t nodes = 0;  ///< of the tree, inner ones included; 0: there is no tree
  double resolution = 0.0;  ///< metres
};

/// Takes the header off the front of a file, which stays as it was when the answer is a refusal.
/// Stricter than OctoMap: each of `id`, `size` and `res` stands there exactly once, and nothing unknown.
[[nodiscard]] Result<OctomapHeader> read_octomap_header(ByteSpan& in);

void append_octomap_header(Bytes& out, const OctomapHeader& header);

}  // namespace concord
