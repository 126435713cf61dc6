#pragma once

#include <set>
#include <span>
#include <string>

#include "core/corrections.hpp"
#include "merge/people.hpp"

namespace concord {

/// Ids of those corrections of a saved map that are new here and have nothing left to do: an undo or redo of an edit
/// that is so already; what was done to a zone that is gone by the file's end, where it does not follow on the zones
/// here (another of that name is there, or it is gone here as well). A zone that stands at the file's end is never
/// spent. @pre `saved` is a list that CorrectionCheck takes.
[[nodiscard]] std::set<std::string> spent_corrections(std::span<const Correction> saved, const People& people);

}  // namespace concord
