#pragma once

#include "align/align.hpp"
#include "align/align_task.hpp"
#include "core/alignment.hpp"

namespace concord {

/// An answer as it is told to people and programs. `ms`: milliseconds that it took.
[[nodiscard]] AlignEvidence account_of(const Alignment& alignment, double ms);

/// The same with what it was found from.
[[nodiscard]] AlignResult result_of(const AlignTask& task, const Alignment& alignment, double ms, std::int64_t utime);

}  // namespace concord
