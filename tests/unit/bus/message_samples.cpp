#include "message_samples.hpp"

#include "bus/messages_asset.hpp"
#include "bus/messages_detection.hpp"
#include "bus/messages_label.hpp"
#include "bus/messages_map.hpp"

namespace concord::test {
namespace {

constexpr std::int64_t kTime = 1'700'000'000'123'456;

template <class T>
Bytes written(const T& value) {
  if constexpr (requires { encode(value); }) {
    return encode(value);
  } else {
    return encode(value, kTime);
  }
}

template <class T>
MessageSample sample(const std::string& type, const T& value) {
  return {type, written(value), [](std::span<const std::uint8_t> bytes) -> Decoded<Bytes> {
            const auto read = decode<T>(bytes);
            if (!read) return tl::unexpected(read.error());
            return written(*read);
          }};
}

Transform some_transform() {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(1, -2, 3);
  return T;
}

EditRequest edit(EditRequest::Op op, Shape shape) {
  return {"e-1", "Zoë", op, std::move(shape), {"headset", "h-1"}, Eigen::Vector3d::Zero(), 17, kTime, {"e-0", "é"}};
}

EditRequest moved(EditRequest edit) {
  edit.move = {0.5, -1, 2};
  return edit;
}

const Box kBox{{-1, 0, 0}, {1, 2.5, 3}};
const OrientedBox kOriented{some_transform(), {1, 2, 3}};
const Prism kPrism{{{0, 0}, {4, 0}, {4, 3}, {1, 1}}, -0.5, 2};

LabelRequest label(LabelRequest::Op op, Shape shape = VoxelList{}) {
  LabelRequest out{"n-1", "Zoë", op, "chair", {3, 4'000}, 7, "", std::move(shape), {"headset", "h-1"}, kTime};
  if (op == LabelRequest::Op::kUndo) out.correction_id = "n-0";
  return out;
}

Zone zone(const std::string& name, Volume volume) {
  return {name, Zone::Kind::kAllowContact, std::move(volume), some_transform(), "Zoë", kTime, 5, 0, 0};
}

PathRequest asked_path() {
  PathRequest request;
  request.id = "r-6";
  request.robot = "robot1";
  request.start = Eigen::Vector2d(1, 2);
  request.goal = {3, 4};
  request.radius = 0.4;
  request.keep_active = true;
  request.waypoints = {{2, 2}};
  return request;
}

PathRequest cancelled_path() {
  PathRequest request;
  request.id = "r-7";
  request.robot = "robot1";
  request.op = PathRequest::Op::kCancel;
  return request;
}

Path no_path() {
  Path path;
  path.id = "r-6";
  path.robot = "robot1";
  path.status = "NO_VALID_PATH";
  path.message = "none";
  path.map_revision = 77;
  path.plan_number = 2;
  path.active = true;
  path.utime = kTime;
  return path;
}

Path some_path() {
  Path path = no_path();
  path.status = "OK";
  path.message = "a path";
  path.points = {{1, 2, 0}, {3, 4, 0}};
  path.length = 2.8;
  path.least_clearance = 0.5;
  path.details = {{0.8, 0.5, 0, 0.0}, {0.8, 0.6, 1, 5.6}};
  path.path_id = 1LL << 40;
  path.superseded = 17;
  path.edit_id = "e-1";
  path.frame_agent = "headset1";
  path.frame_id = "room";
  path.radius = 0.3;
  path.zmin = 0.1;
  path.zmax = 1.8;
  path.failed_leg = 2;
  path.nearest = Eigen::Vector2d(3, 5);
  path.footprint = {{1, 1}, {-1, 1}, {0, -2}};
  path.turn_radius = 0.75;
  path.zones = {"Schweißzelle 2", "wet floor"};
  return path;
}

AlignResult align_result() {
  Alignment evidence;
  evidence.reason = AlignReason::kDegenerate;
  evidence.message = "the walls leave it open";
  evidence.T_target_source = some_transform();
  evidence.overlap_source = 0.5;
  evidence.overlap_target = 1.0;
  evidence.rms = 0.02;
  evidence.covariance(1, 1) = 1e-4;
  evidence.covariance(0, 1) = 2e-5;
  evidence.p_target_centre = {1.0, 2.0, 0.5};
  evidence.T_target_source_rivals = {some_transform(), Transform::Identity()};
  evidence.loose = {"slides along x (1.00 0.00 0.00)"};
  evidence.against_upright = 0.01;
  evidence.iterations = 40;
  evidence.hypotheses = 8;
  evidence.ms = 12.5;
  return {"a-1", "Zoë", "",   {"robot1", "odom", 7}, {{"robot2", "map", 9}, {"robot3", "odom", 0}}, evidence, true,
          0.25,  0.02,  kTime};
}

}  // namespace

const std::vector<MessageSample>& message_samples() {
  static const std::vector<MessageSample> kSamples = {
      sample("brick_packet_t", BrickPacket{kTime, 17, "map", 0.05, 3, 9, 2, {1, 2, 3, 255, 0}, 4}),
      sample("brick_digest_t", BrickDigest{kTime, 17, "map", 0.05, 12, 9, 0xFFEEDDCCBBAA9988, 4}),
      sample("map_edits_t", MapEdits{kTime, 17, 5, 12}),
      sample("brick_request_t", BrickRequest{17, {{1, 2}, {5, 5}, {9, 1'000'000'000'000}}}),
      sample("octomap_t", OctomapMessage{kTime, "odom", 0.1, false, {0, 1, 2, 3}}),
      sample("cloud_t", CloudMessage{kTime, 17, 5, "odom", some_transform(), 12.5, {{1, 2, 3}, {-4, 5.5F, 6}}}),
      sample("agent_pose_t", AgentPose{"", "odom", some_transform(), kTime}),
      sample("frame_over_t", FrameOver{kTime, "odom"}),
      sample("map_pose_t", MapPose{kTime, "robot1", some_transform()}),
      sample("set_transform_t", TransformRequest{"r-1", "Zoë", "robot1", "odom", some_transform()}),
      sample("edit_t",
             edit(EditRequest::Op::kDelete, VoxelList{0.05, {{{-1, 0, 0}, {0, 0, 0}}, {{5, 6, 7}, {6, 9, 7}}}})),
      sample("edit_t", edit(EditRequest::Op::kAdd, Line{{{0, 0, 0}, {1, 1, 1}, {2, 0, 0}}, 0.2})),
      sample("edit_t", edit(EditRequest::Op::kDelete, Area{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, 0.1})),
      sample("edit_t", moved(edit(EditRequest::Op::kMove, kBox))),
      sample("edit_t", edit(EditRequest::Op::kAdd, kOriented)),
      sample("edit_t", edit(EditRequest::Op::kAdd, kPrism)),
      sample("undo_t", UndoRequest{"u-1", "Zoë", "e-1", true, kTime}),
      sample("zone_request_t", ZoneRequest{"z-1",
                                           "Zoë",
                                           ZoneRequest::Op::kChange,
                                           "Line 3 €",
                                           Zone::Kind::kNoGo,
                                           kPrism,
                                           {"headset", ""},
                                           4,
                                           kTime,
                                           0.5,
                                           0}),
      sample("zone_request_t", ZoneRequest{"z-3",
                                           "Zoë",
                                           ZoneRequest::Op::kAdd,
                                           "slow",
                                           Zone::Kind::kCostly,
                                           kPrism,
                                           {},
                                           kAnyRevision,
                                           kTime,
                                           1.25,
                                           7}),
      sample("zone_request_t",
             ZoneRequest{"z-2", "", ZoneRequest::Op::kDelete, "dock", Zone::Kind::kNoGo, {}, {}, kAnyRevision, kTime}),
      sample("lease_request_t", LeaseRequest{"l-1", "Zoë", "my corner", true, kOriented, {}, kTime}),
      sample("lease_request_t", LeaseRequest{"l-2", "Zoë", "my corner", false, {}, {}, kTime}),
      sample("weight_request_t", WeightRequest{"w-1", "Zoë", "robot1", 1000, kTime}),
      sample("localise_request_t",
             LocaliseRequest{"p-1", "Zoë", "robot1", some_transform(), {"headset", "h-1"}, kTime}),
      sample("history_request_t", HistoryRequest{"h-1", "Zoë", "dock", Operation::Kind::kZoneAdd, 1, kTime, 5, 10'000}),
      sample("history_t",
             HistoryPart{"h-1",
                         1,
                         2,
                         {{7, "e-1", "Zoë", kTime, Operation::Kind::kMove, "", 12, false, {-5, 0, 1}, {5, 0, 1}},
                          {8, "w-1", "", kTime, Operation::Kind::kWeight, "robot1", 0, true, {}, {}}}}),
      sample("conflict_request_t", ConflictRequest{"c-1", 7}),
      sample("conflict_list_t", ConflictList{"c-1",
                                             0,
                                             3,
                                             70,
                                             900,
                                             {{{0, 0, 0}, {3, 4, 5}, 20, {{"robot1", 15, 5}, {"robot2", 0, 20}}},
                                              {{-9, -9, -9}, {-8, -8, -8}, 1, {}}}}),
      sample("zones_t", ListPart<Zone>{0xFFEEDDCCBBAA9988, 1, 2, {zone("a", kBox), zone("b", kPrism)}, {}}),
      sample("leases_t", ListPart<Lease>{5, 0, 1, {{"l-1", "Zoë", kOriented, some_transform(), kTime}}, {}}),
      sample("label_request_t", label(LabelRequest::Op::kLabel, kPrism)),
      sample("label_request_t", label(LabelRequest::Op::kRestore, VoxelList{0.05, {{{-3, 0, 1}, {5, 0, 1}}}})),
      sample("label_request_t", label(LabelRequest::Op::kDelete)),
      sample("label_request_t", label(LabelRequest::Op::kTouch, Box{{0, 0, 0}, {0.1, 0.1, 0.1}})),
      sample("label_request_t", label(LabelRequest::Op::kUndo)),
      sample("asset_request_t",
             AssetRequest{"s-1", "Zoë", AssetRequest::Op::kInject, "pallet", "", {}, some_transform(), kTime}),
      sample("asset_request_t",
             AssetRequest{"s-2", "Zoë", AssetRequest::Op::kMove, "", "s-1", {}, some_transform(), kTime}),
      sample("asset_request_t",
             AssetRequest{"s-3", "Zoë", AssetRequest::Op::kDelete, "", "", {3, 7}, Transform::Identity(), kTime}),
      sample("assets_t",
             ListPart<Asset>{7, 0, 1, {{"pallet", "Palette", "pallet.glb", 0.001, 12'345, {1.2, 0.8, 0.144}}}, {}}),
      sample("detection_t",
             Detection{"v-1", "hmd", "fork lift", "target 7", 0.75, some_transform(), {"headset", "h-1"}, kTime}),
      sample("detection_decision_t", DetectionDecision{"v-2", "Zoë", DetectionDecision::Op::kDrop, 12, kTime}),
      sample("things_t",
             ListPart<Thing>{7, 0, 1, {{12, "lift", "fork lift", 0.75, 3, kTime, "hmd", some_transform(), "v-2"}}, {}}),
      sample("label_query_t", LabelQuery{"n-2", LabelQuery::Kind::kWithin, "chair", {1, 2, -3}, 4.5}),
      sample("label_list_t",
             LabelList{
                 "n-2", 1, 2, {{{3, 1}, "chair", 50, {-4, 0, 0}, {9, 9, 9}, {0.5, 1, 2}, "pallet", some_transform()}}}),
      sample("label_slots_t", ListPart<LabelSlot>{7, 0, 1, {{0, {3, 1}, "chair"}, {65'534, {9, 2}, "Tür"}}, {}}),
      sample("list_digest_t", ListDigest{0xFFEEDDCCBBAA9988, 3}),
      sample("list_request_t", ListRequest{0xFFEEDDCCBBAA9988}),
      sample("agent_request_t", AgentRequest{"r-2", "robot1", AgentRequest::Op::kRemove}),
      sample("downsample_request_t", DownsampleRequest{"r-3", "robot1", 0.5}),
      sample("downsampled_t", Downsampled{"r-3", "robot1", "odom", 0.5, 1, 2, {{1, 2, 3}}}),
      sample("map_request_t", MapRequest{"r-4", MapRequest::Op::kLoad, "hall", {"concord"}, false, "robot1"}),
      sample("map_request_t", MapRequest{"r-4", MapRequest::Op::kSave, "hall", {"bt", "concord"}, true, ""}),
      sample("map_list_t", MapList{"r-5", {{"a.bt", 100}, {"b.ot", 1LL << 40}}}),
      sample("path_request_t", asked_path()),
      sample("path_request_t", cancelled_path()),
      sample("path_request_t", PathRequest{"r-9",
                                           "robot1",
                                           Eigen::Vector2d(1, 2),
                                           {3, 4},
                                           0,
                                           true,
                                           {},
                                           PathRequest::Op::kPlan,
                                           {{1, 1}, {-1, 1}, {0, -2}},
                                           0.75,
                                           -1.5,
                                           2.5}),
      sample("path_watch_t", PathWatch{"r-8", "", "headset1"}),
      sample("path_t", some_path()),
      sample("path_t", no_path()),
      sample("align_request_t", AlignRequest{"a-1", "Zoë", "robot1", "odom", "robot2", "", some_transform(), kTime}),
      sample("align_request_t", AlignRequest{"a-2", "", "robot1", "", "", "", std::nullopt, kTime}),
      sample("align_decision_t", AlignDecision{"d-1", "Zoë", AlignDecision::Op::kAccept, "a-1", kTime}),
      sample("align_decision_t", AlignDecision{"d-2", "", AlignDecision::Op::kDrop, "a-1", kTime}),
      sample("align_result_t", align_result()),
      sample("answer_t", Answer{"r-1", "merge", true, "OK", "aligned", 5, 6}),
      sample("answer_t", Answer{"r-4", "merge", true, "OK", "saved", 5, 300, 0xFFEEDDCCBBAA9988, {100, 200}}),
      sample("agents_t", AgentList{kTime,
                                   0.05,
                                   {{"a", "lidar", "odom", 3, true, some_transform(), 100, 10, 7, true},
                                    {"b", "headset", "h", 1, false, Transform::Identity(), 0, 0, 0, false}}}),
      sample("status_t", ProcessStatus{kTime, "merge", 17, {{"bytes", 5}, {"refused.x", -1}}}),
  };
  return kSamples;
}

}  // namespace concord::test
