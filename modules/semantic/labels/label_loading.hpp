#pragma once

#include <vector>

#include "semantic/labels/labels.hpp"

namespace concord {

/// The labels of a saved map, as they follow on ours.
///
/// Where nobody labelled anything yet, all that was done to them follows, number by number, and can be undone as
/// there. Else just what holds follows: a class that is called as one here is that class, others get the next number,
/// and an instance keeps its number if it was never given here. What came from the same correction is here already.
/// So asked again after it was done, nothing is left to do.
/// Refused: another correction with one of the ids (kExists); over the caps of Labels (kTooLarge).
/// @param theirs what read_label_section took.
[[nodiscard]] Result<std::vector<LabelCorrection>> labels_to_load(const std::vector<LabelCorrection>& theirs,
                                                                  const Labels& ours);

}  // namespace concord
