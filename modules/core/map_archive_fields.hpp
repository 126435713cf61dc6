#pragma once

#include <vector>

#include "core/lattice.hpp"
#include "core/map_archive_sections.hpp"
#include "core/transform.hpp"

namespace concord::archive {

/// Fields of a map file (map_archive.md) that stand in more than one kind of section.

template <int size>
void append_vector(Bytes& out, const Eigen::Matrix<double, size, 1>& p) {
  for (int i = 0; i < size; ++i) append_real(out, p[i]);
}

template <int size>
[[nodiscard]] Eigen::Matrix<double, size, 1> read_vector(FieldReader& in) {
  Eigen::Matrix<double, size, 1> p;
  for (int i = 0; i < size; ++i) p[i] = in.real();
  return p;
}

/// To the bit: a quaternion would give a map that differs in voxels at an edge.
void append_transform(Bytes& out, const Transform& T);
/// Not checked.
[[nodiscard]] Transform read_transform(FieldReader& in);

/// @pre sorted and unique.
void append_voxels(Bytes& out, const std::vector<VoxelIndex>& voxels);
/// Refused: boxes that to_boxes does not make (kMalformed), over `most` voxels, before memory is taken (kTooLarge).
[[nodiscard]] Result<std::vector<VoxelIndex>> read_voxels(FieldReader& in, std::uint64_t most);

}  // namespace concord::archive
