#pragma once

#include <cstddef>
#include <vector>

#include "bus/messages.hpp"

namespace concord {

/// Divides items, in their order, so that each part fits one frame on the wire, unless one item alone does not. None
/// where there are no items. `size_of(item)` is asked once for each, in their order: its bytes on the wire.
template <class T, class SizeOf>
[[nodiscard]] std::vector<std::vector<T>> pack(const std::vector<T>& items, SizeOf size_of) {
  std::vector<std::vector<T>> parts;
  std::size_t bytes = 0;
  for (const T& item : items) {
    const std::size_t more = size_of(item);
    if (parts.empty() || bytes + more > kPartBytes || parts.back().size() >= kMostInPart) {
      parts.emplace_back();
      bytes = 0;
    }
    parts.back().push_back(item);
    bytes += more;
  }
  return parts;
}

}  // namespace concord
