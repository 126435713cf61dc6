#pragma once

#include <cmath>
#include <cstdint>

namespace concord {

/// Random numbers that are the same on every machine and with every standard library (splitmix64, Steele et al. 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }

  /// In [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Mean 0, deviation 1: the sum of four uniform 16-bit numbers, so never beyond 3.5.
  double normal() {
    const std::uint64_t b = bits();
    const auto sum = static_cast<double>((b & 0xFFFF) + (b >> 16 & 0xFFFF) + (b >> 32 & 0xFFFF) + (b >> 48));
    return (sum - 2.0 * 65535.0) * (std::sqrt(3.0) / 65536.0);
  }

 private:
  std::uint64_t state_;
};

}  // namespace concord
