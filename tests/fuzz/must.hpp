#pragma once

#include <cstdlib>

namespace concord::fuzz {

/// What must hold of any input; the fuzzer keeps the input that breaks it.
inline void must(bool holds) {
  if (!holds) std::abort();
}

}  // namespace concord::fuzz
