// Requests about assets, and about what was seen of them.

#include <charconv>

#include "bridge/ask_semantic.hpp"
#include "bridge/requests.hpp"
#include "bus/messages_asset.hpp"
#include "bus/messages_detection.hpp"
#include "core/text.hpp"

namespace concord::hmd {
namespace {

concord::AssetRequest asset_request(Desk& desk, const Ask& ask, concord::AssetRequest::Op op) {
  concord::AssetRequest request;
  request.id = desk.id(ask);
  request.author = desk.author(ask);
  request.op = op;
  request.utime = desk.now();
  return request;
}

/// An instance by its numbers; refuses the client where no thing can have them.
std::optional<InstanceId> instance_of(Desk& desk, const Ask& ask, std::int64_t label, std::int64_t instance) {
  if (label >= 1 && instance >= 1 && label <= INT32_MAX && instance <= INT32_MAX) {
    return InstanceId{static_cast<ClassId>(label), static_cast<std::uint32_t>(instance)};
  }
  desk.hub.refuse(ask, Code::kNoInstance, "numbers of classes and instances count from 1");
  return std::nullopt;
}

Code adding_code(const std::string& code) { return code == "NOT_FOUND" ? Code::kNoAsset : code_of(code); }
Code instance_code(const std::string& code) { return code == "NOT_FOUND" ? Code::kNoInstance : code_of(code); }

/// The number of what was seen, by the id that clients have of it; 0 if there is none.
std::int64_t number_of(const std::string& detection) {
  std::int64_t number = 0;
  const char* end = detection.data() + detection.size();
  const auto read = std::from_chars(detection.data(), end, number);
  return read.ec == std::errc() && read.ptr == end && number > 0 ? number : 0;
}

}  // namespace

void work_on(Desk& desk, const Ask& ask, const AssetsRequest& /*request*/) {
  if (!desk.world.alive("semantic")) return desk.hub.refuse(ask, Code::kUnavailable, "no process of this stack labels");
  AssetsAnswer answer;
  for (const concord::Asset& asset : desk.world.things().assets()) {
    if (answer.assets.size() >= 1000) break;
    answer.assets.push_back({asset.name, asset.class_name, array_of(asset.size),
                             asset.gltf_bytes > 0 ? desk.models + asset.name + ".glb" : ""});
  }
  desk.hub.answer(ask, answer);
}

void work_on(Desk& desk, const Ask& ask, const AssetAddRequest& request) {
  const auto T = desk.in_map(ask, request.frame, request.T_frame_asset);
  if (!T) return desk.refuse(ask, T.error());
  concord::AssetRequest asked = asset_request(desk, ask, concord::AssetRequest::Op::kInject);
  asked.asset = request.asset;
  asked.T_map_asset = *T;
  ask_semantic(
      desk, ask, asked.id, "in/asset", encode(asked), true,
      [&desk, ask, undo = edit_of_asset(asked.id)](const Answer& answer, const std::vector<LabelInstance>& made) {
        const InstanceId of = made.empty() ? InstanceId{} : made.front().of;
        desk.hub.answer(ask, AssetAddAnswer{of.label, of.instance, answer.count, answer.revision, undo});
      },
      adding_code);
}

void work_on(Desk& desk, const Ask& ask, const AssetMoveRequest& request) {
  const auto T = desk.in_map(ask, request.frame, request.T_frame_asset);
  if (!T) return desk.refuse(ask, T.error());
  const auto of = instance_of(desk, ask, request.label, request.instance);
  if (!of) return;
  concord::AssetRequest asked = asset_request(desk, ask, concord::AssetRequest::Op::kMove);
  asked.instance = *of;
  asked.T_map_asset = *T;
  ask_semantic(
      desk, ask, asked.id, "in/asset", encode(asked), false,
      [&desk, ask, undo = edit_of_asset(asked.id)](const Answer& answer, const std::vector<LabelInstance>&) {
        desk.hub.answer(ask, AssetMoveAnswer{answer.count, answer.revision, undo});
      },
      instance_code);
}

void work_on(Desk& desk, const Ask& ask, const AssetDeleteRequest& request) {
  const auto of = instance_of(desk, ask, request.label, request.instance);
  if (!of) return;
  concord::AssetRequest asked = asset_request(desk, ask, concord::AssetRequest::Op::kDelete);
  asked.instance = *of;
  ask_semantic(
      desk, ask, asked.id, "in/asset", encode(asked), false,
      [&desk, ask](const Answer& answer, const std::vector<LabelInstance>&) {
        desk.hub.answer(ask, AssetDeleteAnswer{answer.revision});
      },
      instance_code);
}

void work_on(Desk& desk, const Ask& ask, const DetectionRequest& request) {
  const auto where = desk.place(ask, request.frame);
  if (!where) return desk.refuse(ask, where.error());
  const auto T = from_hmd(request.T_frame_object);
  if (!T) return desk.refuse(ask, {code_of(T.error()), T.error().message});
  if (request.score < 0 || request.score > 1) return desk.hub.refuse(ask, Code::kBadRequest, "a score is 0 to 1");
  if (!is_title(request.class_name)) return desk.hub.refuse(ask, Code::kBadName, "no class can be called so");
  concord::Detection detection;
  detection.id = desk.id(ask);
  detection.author = desk.author(ask);
  detection.asset = request.class_name;
  detection.score = request.score;
  detection.T_frame_asset = *T;
  detection.frame = where->frame;
  detection.utime = desk.now();
  ask_semantic(
      desk, ask, detection.id, "in/detection", encode(detection), false,
      [&desk, ask](const Answer& answer, const std::vector<LabelInstance>&) {
        desk.hub.answer(ask, DetectionAnswer{std::to_string(answer.revision)});
      },
      adding_code);
}

void work_on(Desk& desk, const Ask& ask, const DetectionConfirmRequest& request) {
  concord::DetectionDecision decision;
  decision.id = desk.id(ask);
  decision.author = desk.author(ask);
  decision.thing = number_of(request.detection);
  decision.utime = desk.now();
  if (decision.thing == 0) return desk.hub.refuse(ask, Code::kExpired, "nothing that waits has this id");
  ask_semantic(
      desk, ask, decision.id, "in/detection_decision", encode(decision), true,
      [&desk, ask, undo = edit_of_asset(decision.id)](const Answer& answer, const std::vector<LabelInstance>& made) {
        const InstanceId of = made.empty() ? InstanceId{} : made.front().of;
        desk.hub.answer(ask, DetectionConfirmAnswer{of.label, of.instance, answer.count, answer.revision, undo,
                                                    cut_to(answer.message, 400)});
      },
      [&desk, thing = decision.thing](const std::string& code) {
        if (code == "NOT_FOUND" && desk.world.things().thing(thing) != nullptr) return Code::kNoAsset;
        return code == "NOT_FOUND" || code == "CONFLICT" ? Code::kExpired : code_of(code);
      });
}

void work_on(Desk& desk, const Ask& ask, const DetectionRejectRequest& request) {
  concord::DetectionDecision decision;
  decision.id = desk.id(ask);
  decision.author = desk.author(ask);
  decision.op = concord::DetectionDecision::Op::kDrop;
  decision.thing = number_of(request.detection);
  decision.utime = desk.now();
  if (decision.thing == 0) return desk.hub.refuse(ask, Code::kExpired, "nothing that waits has this id");
  ask_semantic(
      desk, ask, decision.id, "in/detection_decision", encode(decision), false,
      [&desk, ask](const Answer&, const std::vector<LabelInstance>&) { desk.hub.answer(ask, DetectionRejectAnswer{}); },
      [](const std::string& code) {
        return code == "NOT_FOUND" || code == "CONFLICT" ? Code::kExpired : code_of(code);
      });
}

}  // namespace concord::hmd
