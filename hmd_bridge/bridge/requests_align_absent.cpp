// Requests to a process that is not of this stack yet: aligning.

#include "bridge/requests.hpp"

namespace concord::hmd {
namespace {

void not_here(Desk& desk, const Ask& ask) {
  desk.hub.refuse(ask, Code::kUnavailable, "no process of this stack aligns");
}

}  // namespace

void work_on(Desk& desk, const Ask& ask, const AlignRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const AlignAcceptRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const AlignDropRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const ReferenceRequest&) { not_here(desk, ask); }

void hear_alignments(Desk&) {}

}  // namespace concord::hmd
