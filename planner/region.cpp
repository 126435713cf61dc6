#include "planner/region.hpp"

#include <algorithm>

namespace concord {
namespace {

/// Bits first to last of eight, as far as they are among 0 to 7.
std::uint64_t span(int first, int last) {
  return (0xFFU << std::max(first, 0) & 0xFFU) & 0xFFU >> (7 - std::min(last, 7));
}

}  // namespace

bool Region::is_near(BrickIndex column) const {
  for (std::int32_t y = (column.y - margin_) >> 3; y <= (column.y + margin_) >> 3; ++y) {
    for (std::int32_t x = (column.x - margin_) >> 3; x <= (column.x + margin_) >> 3; ++x) {
      const auto tile = tiles_.find({x, y});
      if (tile == tiles_.end()) continue;
      const std::uint64_t row = span(column.x - margin_ - 8 * x, column.x + margin_ - 8 * x);
      const int last = std::min(column.y + margin_ - 8 * y, 7);
      for (int i = std::max(column.y - margin_ - 8 * y, 0); i <= last; ++i) {
        if ((tile->second >> (8 * i) & row) != 0) return true;
      }
    }
  }
  return false;
}

}  // namespace concord
