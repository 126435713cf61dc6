// Requests to a process that is not of this stack yet: labelling.

#include "bridge/requests.hpp"

namespace concord::hmd {
namespace {

void not_here(Desk& desk, const Ask& ask) {
  desk.hub.refuse(ask, Code::kUnavailable, "no process of this stack labels");
}

}  // namespace

void work_on(Desk& desk, const Ask& ask, const AssetsRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const AssetAddRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const AssetMoveRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const AssetDeleteRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const DetectionRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const DetectionConfirmRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const DetectionRejectRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const LabelsRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const InstancesRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const LabelRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const InstanceDeleteRequest&) { not_here(desk, ask); }
void work_on(Desk& desk, const Ask& ask, const LabelDeleteRequest&) { not_here(desk, ask); }

}  // namespace concord::hmd
