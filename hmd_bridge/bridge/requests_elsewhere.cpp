// Requests to processes that are not of this stack yet: aligning and labelling.

#include "bridge/requests.hpp"

namespace concord::hmd {
namespace {

void not_here(Desk& desk, const Ask& ask, const char* process) {
  desk.hub.refuse(ask, Code::kUnavailable, std::string("no process of this stack is called ") + process);
}

}  // namespace

void work_on(Desk& desk, const Ask& ask, const AlignRequest&) { not_here(desk, ask, "align"); }
void work_on(Desk& desk, const Ask& ask, const AlignAcceptRequest&) { not_here(desk, ask, "align"); }
void work_on(Desk& desk, const Ask& ask, const AlignDropRequest&) { not_here(desk, ask, "align"); }
void work_on(Desk& desk, const Ask& ask, const ReferenceRequest&) { not_here(desk, ask, "align"); }

void work_on(Desk& desk, const Ask& ask, const AssetsRequest&) { not_here(desk, ask, "semantic"); }
void work_on(Desk& desk, const Ask& ask, const AssetAddRequest&) { not_here(desk, ask, "semantic"); }
void work_on(Desk& desk, const Ask& ask, const AssetMoveRequest&) { not_here(desk, ask, "semantic"); }
void work_on(Desk& desk, const Ask& ask, const AssetDeleteRequest&) { not_here(desk, ask, "semantic"); }
void work_on(Desk& desk, const Ask& ask, const DetectionRequest&) { not_here(desk, ask, "semantic"); }
void work_on(Desk& desk, const Ask& ask, const DetectionConfirmRequest&) { not_here(desk, ask, "semantic"); }
void work_on(Desk& desk, const Ask& ask, const DetectionRejectRequest&) { not_here(desk, ask, "semantic"); }
void work_on(Desk& desk, const Ask& ask, const LabelsRequest&) { not_here(desk, ask, "semantic"); }
void work_on(Desk& desk, const Ask& ask, const InstancesRequest&) { not_here(desk, ask, "semantic"); }
void work_on(Desk& desk, const Ask& ask, const LabelRequest&) { not_here(desk, ask, "semantic"); }
void work_on(Desk& desk, const Ask& ask, const InstanceDeleteRequest&) { not_here(desk, ask, "semantic"); }
void work_on(Desk& desk, const Ask& ask, const LabelDeleteRequest&) { not_here(desk, ask, "semantic"); }

}  // namespace concord::hmd
