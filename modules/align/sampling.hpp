#pragma once

#include <cstddef>
#include <cstdint>

namespace concord {

/// The `i`-th of `take` items spread over `count`: one from each equal part, at a place in it that keeps no step with
/// whatever order the items have (rings of a lidar, rows of a lattice). Never descending. @pre take <= count < 2^32.
[[nodiscard]] constexpr std::size_t spread(std::size_t i, std::size_t take, std::size_t count) {
  const std::uint64_t golden = (i * 0x9E3779B9ULL) & 0xFFFFFFFFULL;  // Weyl's sequence, 32 bits
  return static_cast<std::size_t>((i * count + (golden * count >> 32)) / take);
}

}  // namespace concord
