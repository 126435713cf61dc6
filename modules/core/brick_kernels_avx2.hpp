#pragma once

#include "core/brick_kernels.hpp"

namespace concord {

/// Null where the machine or the compiler has no AVX2.
[[nodiscard]] const BrickKernels* avx2_kernels();

}  // namespace concord
