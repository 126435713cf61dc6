#pragma once

#include <cstddef>

namespace concord::test {

/// Bytes asked of operator new since the program began, by this thread. What was freed since still counts.
[[nodiscard]] std::size_t bytes_allocated();

}  // namespace concord::test
