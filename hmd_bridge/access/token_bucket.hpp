#pragma once

#include <algorithm>
#include <cstdint>

namespace concord::hmd {

/// So much a second in the long run, and `burst` at once.
class TokenBucket {
 public:
  TokenBucket(double per_second, double burst) : per_second_(per_second), burst_(burst), level_(burst) {}

  /// Takes `amount` if it is there. `now` in microseconds, never earlier than before.
  [[nodiscard]] bool take(double amount, std::int64_t now) {
    if (since_ != 0) level_ = std::min(burst_, level_ + static_cast<double>(now - since_) * 1e-6 * per_second_);
    since_ = now;
    if (level_ < amount) return false;
    level_ -= amount;
    return true;
  }
  [[nodiscard]] bool full(std::int64_t now) const {
    return level_ + static_cast<double>(now - since_) * 1e-6 * per_second_ >= burst_;
  }

 private:
  double per_second_, burst_, level_;
  std::int64_t since_ = 0;
};

}  // namespace concord::hmd
