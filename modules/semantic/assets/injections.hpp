#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/corrections.hpp"
#include "semantic/labels/labels.hpp"

namespace concord {

/// Models in the map that were moved: each place is an edit of its own in merge, and of those that one request began
/// just one holds. Merge undoes and redoes one edit at a time, so semantic asks for the other half; it says in the ids
/// of such requests that it does.

/// Where what this request injected is now; nothing if it is not in the map.
[[nodiscard]] std::optional<Labels::Injected> where_is(const std::string& request_id, const Labels& labels);

/// All models that are in the map, where they are now, by the ids of the requests that injected them.
[[nodiscard]] std::map<std::string, Labels::Injected> placed(const Labels& labels);

/// Whether a moved model is out of its old place; of one that was never moved, and of what is undone, yes.
[[nodiscard]] bool has_moved(const Labels::Injected& injected, const Labels& labels);

/// What must be asked of merge still: that a model that was put elsewhere leaves its old place, and that it comes back
/// there when that was undone. Not where a person has said otherwise of the old place since. The same until merge has
/// done it, to the byte: ids are taken from the revision that called for it.
[[nodiscard]] std::vector<UndoRequest> due(const Labels& labels);

/// The undo that takes a model out of the map for good, not back to where it was.
[[nodiscard]] UndoRequest removal(const std::string& edit_id, const std::string& request_id, const std::string& author);

/// Whether such a request of ours has this id.
[[nodiscard]] bool is_ours(const std::string& request_id);
/// The request that a removal was asked by; empty: this is none.
[[nodiscard]] std::string asked_removal(const std::string& request_id);
/// The edit that came into the place of the one that this request of ours undoes; empty: it is none that does.
[[nodiscard]] std::string moved_by(const std::string& request_id);

}  // namespace concord
