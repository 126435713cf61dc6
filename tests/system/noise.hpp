#pragma once

#include <cstdint>

#include "core/brick_map.hpp"

namespace concord::test {

/// Voxels that no codec can shorten much, a different brick each time.
[[nodiscard]] inline DenseBrick noise(std::uint32_t& state) {
  DenseBrick dense;
  for (LogOdds& value : dense) {
    state = state * 1664525U + 1013904223U;
    value = (state >> 24) < 100 ? static_cast<LogOdds>(static_cast<int>((state >> 12) % 4000) - 2000) : kUnknown;
  }
  return dense;
}

/// A slab of edge * edge such bricks.
[[nodiscard]] inline BrickMap noisy_map(int edge, std::uint32_t seed) {
  BrickMap map;
  for (int x = 0; x < edge; ++x) {
    for (int y = 0; y < edge; ++y) map.set({x, y, 0}, Brick::from_dense(noise(seed)));
  }
  return map;
}

}  // namespace concord::test
