#pragma once

#include "bridge/desk.hpp"

namespace concord::hmd {

/// Each works on one request: answers or refuses it through `desk.hub`, at once or when the stack has answered. They
/// are in requests_*.cpp, by what they are about.
void work_on(Desk& desk, const Ask& ask, const AgentsRequest& request);
void work_on(Desk& desk, const Ask& ask, const ResetRequest& request);
void work_on(Desk& desk, const Ask& ask, const RemoveRequest& request);
void work_on(Desk& desk, const Ask& ask, const WeightRequest& request);
void work_on(Desk& desk, const Ask& ask, const MinimapRequest& request);
void work_on(Desk& desk, const Ask& ask, const AlignRequest& request);
void work_on(Desk& desk, const Ask& ask, const AlignAcceptRequest& request);
void work_on(Desk& desk, const Ask& ask, const AlignDropRequest& request);
void work_on(Desk& desk, const Ask& ask, const AlignUndoRequest& request);
void work_on(Desk& desk, const Ask& ask, const PlaceRequest& request);
void work_on(Desk& desk, const Ask& ask, const ReferenceRequest& request);
void work_on(Desk& desk, const Ask& ask, const ViewRequest& request);
void work_on(Desk& desk, const Ask& ask, const ViewCloseRequest& request);
void work_on(Desk& desk, const Ask& ask, const ConflictsRequest& request);
void work_on(Desk& desk, const Ask& ask, const EditRequest& request);
void work_on(Desk& desk, const Ask& ask, const UndoRequest& request);
void work_on(Desk& desk, const Ask& ask, const RedoRequest& request);
void work_on(Desk& desk, const Ask& ask, const HistoryRequest& request);
void work_on(Desk& desk, const Ask& ask, const AssetsRequest& request);
void work_on(Desk& desk, const Ask& ask, const AssetAddRequest& request);
void work_on(Desk& desk, const Ask& ask, const AssetMoveRequest& request);
void work_on(Desk& desk, const Ask& ask, const AssetDeleteRequest& request);
void work_on(Desk& desk, const Ask& ask, const DetectionRequest& request);
void work_on(Desk& desk, const Ask& ask, const DetectionConfirmRequest& request);
void work_on(Desk& desk, const Ask& ask, const DetectionRejectRequest& request);
void work_on(Desk& desk, const Ask& ask, const LabelsRequest& request);
void work_on(Desk& desk, const Ask& ask, const InstancesRequest& request);
void work_on(Desk& desk, const Ask& ask, const LabelRequest& request);
void work_on(Desk& desk, const Ask& ask, const LabelTouchRequest& request);
void work_on(Desk& desk, const Ask& ask, const LabelRenameRequest& request);
void work_on(Desk& desk, const Ask& ask, const InstanceReassignRequest& request);
void work_on(Desk& desk, const Ask& ask, const InstanceDeleteRequest& request);
void work_on(Desk& desk, const Ask& ask, const LabelDeleteRequest& request);
void work_on(Desk& desk, const Ask& ask, const ZoneAddRequest& request);
void work_on(Desk& desk, const Ask& ask, const ZoneChangeRequest& request);
void work_on(Desk& desk, const Ask& ask, const ZoneDeleteRequest& request);
void work_on(Desk& desk, const Ask& ask, const LeaseHoldRequest& request);
void work_on(Desk& desk, const Ask& ask, const LeaseFreeRequest& request);
void work_on(Desk& desk, const Ask& ask, const SceneGetRequest& request);
void work_on(Desk& desk, const Ask& ask, const SceneSendRequest& request);
void work_on(Desk& desk, const Ask& ask, const RobotCorrectRequest& request);
void work_on(Desk& desk, const Ask& ask, const RobotPoseRequest& request);
void work_on(Desk& desk, const Ask& ask, const PathRequest& request);
void work_on(Desk& desk, const Ask& ask, const PlanRequest& request);
void work_on(Desk& desk, const Ask& ask, const GoalRequest& request);
void work_on(Desk& desk, const Ask& ask, const ObstacleAddRequest& request);
void work_on(Desk& desk, const Ask& ask, const ObstacleRemoveRequest& request);
void work_on(Desk& desk, const Ask& ask, const GridRequest& request);
void work_on(Desk& desk, const Ask& ask, const SaveRequest& request);
void work_on(Desk& desk, const Ask& ask, const MapsRequest& request);
void work_on(Desk& desk, const Ask& ask, const LoadRequest& request);
void work_on(Desk& desk, const Ask& ask, const SendMapRequest& request);

/// Undo or redo of a label correction: the part of its id after kLabelUndo.
void undo_label(Desk& desk, const Ask& ask, const std::string& correction, bool redo);
/// What undo ids of label corrections begin with, so that they are told from edits' (a request's id has no slash).
inline constexpr std::string_view kLabelUndo = "label/";

/// Hears what the align process says; once, at the start.
void hear_alignments(Desk& desk);

}  // namespace concord::hmd
