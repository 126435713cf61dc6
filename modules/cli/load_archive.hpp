#pragma once

#include "cli/live.hpp"

namespace concord {

/// Loads a saved map whole, layers and corrections: ingest makes its layers agents, and merge adds what people made
/// once those have reached it; until then merge is busy and asked again, as long as something arrives. Fails with what
/// either refused it for, kNoAnswer, or kIncomplete. @pre request.format is "concord".
[[nodiscard]] Outcome load_archive(Live& live, const MapRequest& request, const Common& common);

}  // namespace concord
