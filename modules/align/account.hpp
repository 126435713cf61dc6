#pragma once

#include "align/align.hpp"
#include "core/alignment.hpp"

namespace concord {

/// An answer as it is told to people and programs. `ms`: milliseconds that it took.
[[nodiscard]] AlignEvidence account_of(const Alignment& alignment, double ms);

}  // namespace concord
