#pragma once

#include <algorithm>
#include <cstdint>

namespace concord {

/// A token bucket that all senders on one bus share: what one process says at once must fit into its hearers' buffers.
class Pace {
 public:
  /// Bytes that may be sent now. Time that passed earns more, up to a burst well inside a default socket buffer.
  [[nodiscard]] double available(std::int64_t utime, double bytes_per_second) {
    if (last_ != 0) budget_ += bytes_per_second * static_cast<double>(std::max<std::int64_t>(0, utime - last_)) * 1e-6;
    budget_ = std::min(budget_, kBurstBytes);
    last_ = utime;
    return budget_;
  }
  void spend(double bytes) { budget_ -= bytes; }

 private:
  static constexpr double kBurstBytes = 100'000;

  double budget_ = 0;
  std::int64_t last_ = 0;
};

}  // namespace concord
