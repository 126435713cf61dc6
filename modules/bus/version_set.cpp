#include <algorithm>
#include <iterator>

#include "bus/brick_stream.hpp"

namespace concord {

void VersionSet::add(std::int64_t first, std::int64_t last) {
  auto it = intervals_.upper_bound(first);
  if (it != intervals_.begin() && std::prev(it)->second >= first - 1) {
    --it;
    it->second = std::max(last, it->second);
  } else {
    it = intervals_.emplace_hint(it, first, last);
  }
  for (auto next = std::next(it); next != intervals_.end() && next->first <= it->second + 1;) {
    it->second = std::max(it->second, next->second);
    next = intervals_.erase(next);
  }
}

bool VersionSet::touches(std::int64_t first, std::int64_t last) const {
  const auto after = intervals_.upper_bound(last + 1);
  return after != intervals_.begin() && std::prev(after)->second >= first - 1;
}

void VersionSet::remove(std::int64_t first, std::int64_t last) {
  auto it = intervals_.upper_bound(first);
  if (it != intervals_.begin() && std::prev(it)->second >= first) --it;
  while (it != intervals_.end() && it->first <= last) {
    const auto [low, high] = *it;
    it = intervals_.erase(it);
    if (low < first) intervals_.emplace(low, first - 1);
    if (high > last) {
      intervals_.emplace(last + 1, high);
      return;
    }
  }
}

bool VersionSet::contains(std::int64_t first, std::int64_t last) const {
  const auto it = intervals_.upper_bound(first);
  return it != intervals_.begin() && std::prev(it)->second >= last;
}

std::vector<std::pair<std::int64_t, std::int64_t>> VersionSet::missing(std::int64_t last) const {
  std::vector<std::pair<std::int64_t, std::int64_t>> holes;
  std::int64_t next = 1;
  for (const auto& [low, high] : intervals_) {
    if (next > last) break;
    if (low > next) holes.emplace_back(next, std::min(low - 1, last));
    next = high + 1;
  }
  if (next <= last) holes.emplace_back(next, last);
  return holes;
}

}  // namespace concord
