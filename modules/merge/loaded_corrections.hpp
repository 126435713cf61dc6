#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/correction_check.hpp"
#include "core/map_archive.hpp"
#include "merge/people.hpp"

namespace concord {

/// A saved map that is being loaded, and where to.
struct Loading {
  const MapArchive& archive;  ///< its layers' bricks are not looked at
  std::string request_id;
  std::int64_t incarnation;  ///< of the agents that its layers have become, see loaded_incarnation
  std::int64_t utime;        ///< now
};

/// What people corrected in a saved map, as it follows on what people corrected here: those whose ids are new, in their
/// order, with revisions that go on from ours. Nobody who is here moves or weighs differently for it: placements of the
/// file's layers hold for what these have become, all others for nobody, and weights of other agents are left out. A
/// layer whose placement is known here, for the agent that it was before, is placed anew, and one that would not weigh
/// here what it weighed there is given that weight. Asked again after it was done, nothing is left to do.
///
/// `weight_here`: of an agent that nobody gave a weight. `ours` has taken all corrections that were made here. Refused:
/// another correction with one of the ids, or a zone whose name is taken (kExists), more than all edits together may
/// keep (kTooLarge), and what else CorrectionCheck refuses of the whole.
[[nodiscard]] Result<std::vector<Correction>> corrections_to_load(
    const Loading& loading, const People& people, CorrectionCheck ours,
    const std::function<int(const std::string& agent)>& weight_here);

}  // namespace concord
