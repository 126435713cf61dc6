// Translators of what people, robots and programs ask for, beside corrections (messages_correction.cpp).

#include <concord/agent_pose_t.hpp>
#include <concord/agent_request_t.hpp>
#include <concord/downsample_request_t.hpp>
#include <concord/map_request_t.hpp>

#include "bus/translate.hpp"

namespace concord {
namespace {

using wire::bad;

tl::unexpected<BadMessage> bad_agent(const std::string& id) {
  return bad(Code::kBadName, std::string("agent must be ") + kNameRule, id);
}

}  // namespace

Bytes encode(const AgentPose& value) {
  agent_pose_t out;
  out.utime = value.utime;
  out.frame_id = value.frame_id;
  out.T_agent_base = wire::to_wire(value.T_agent_base);
  return wire::to_bytes(out);
}

template <>
Decoded<AgentPose> decode<AgentPose>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kNameLength), fixed(wire::kTransformBytes)};
  const auto in = wire::from_bytes<agent_pose_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  if (!is_name(in->frame_id)) return bad(Code::kBadFrame, std::string("frame_id must be ") + kNameRule);
  if (const auto utime = wire::time_of(in->utime); !utime) return bad(utime.error());
  const auto T = wire::from_wire(in->T_agent_base);
  if (!T) return bad(T.error());
  return AgentPose{{}, in->frame_id, *T, in->utime};
}

Bytes encode(const AgentRequest& value, std::int64_t utime) {
  agent_request_t out;
  out.utime = utime;
  out.request_id = value.id;
  out.agent = value.agent;
  out.op = value.op == AgentRequest::Op::kReset ? agent_request_t::RESET : agent_request_t::REMOVE;
  return wire::to_bytes(out);
}

template <>
Decoded<AgentRequest> decode<AgentRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kIdLength), text(wire::kNameLength), fixed(1)};
  const auto in = wire::request_from_bytes<agent_request_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  if (!is_name(in->agent)) return bad_agent(in->request_id);
  switch (in->op) {
    case agent_request_t::RESET: return AgentRequest{in->request_id, in->agent, AgentRequest::Op::kReset};
    case agent_request_t::REMOVE: return AgentRequest{in->request_id, in->agent, AgentRequest::Op::kRemove};
    default: return bad(Code::kBadRequest, "op must be RESET or REMOVE", in->request_id);
  }
}

Bytes encode(const DownsampleRequest& value, std::int64_t utime) {
  downsample_request_t out;
  out.utime = utime;
  out.request_id = value.id;
  out.agent = value.agent;
  out.resolution = value.resolution;
  return wire::to_bytes(out);
}

template <>
Decoded<DownsampleRequest> decode<DownsampleRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kIdLength), text(wire::kNameLength), fixed(8)};
  const auto in = wire::request_from_bytes<downsample_request_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  if (!is_name(in->agent)) return bad_agent(in->request_id);
  if (!(in->resolution > 0 && in->resolution <= 100)) {
    return bad(Code::kBadResolution, "resolution must lie between 0 and 100 m", in->request_id);
  }
  return DownsampleRequest{in->request_id, in->agent, in->resolution};
}

Bytes encode(const MapRequest& value, std::int64_t utime) {
  map_request_t out;
  out.utime = utime;
  out.request_id = value.id;
  switch (value.op) {
    case MapRequest::Op::kSave: out.op = map_request_t::SAVE; break;
    case MapRequest::Op::kList: out.op = map_request_t::LIST; break;
    case MapRequest::Op::kLoad: out.op = map_request_t::LOAD; break;
  }
  out.map = value.map;
  out.formats = value.formats;
  out.count = static_cast<std::int32_t>(out.formats.size());
  out.overwrite = value.overwrite;
  out.agent = value.agent;
  return wire::to_bytes(out);
}

namespace {

bool are_formats(const MapRequest& request) {
  const auto is_once = [&](const std::string& format) {
    return (format == "bt" || format == "ot" || format == "concord") &&
           std::ranges::count(request.formats, format) == 1;
  };
  const std::size_t n = request.formats.size();
  return std::ranges::all_of(request.formats, is_once) && (request.op == MapRequest::Op::kLoad ? n <= 1 : n >= 1);
}

}  // namespace

template <>
Decoded<MapRequest> decode<MapRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {
      fixed(8), text(wire::kIdLength),  fixed(1), text(wire::kNameLength), count(3), texts(7),
      fixed(1), text(wire::kNameLength)};
  const auto in = wire::request_from_bytes<map_request_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  MapRequest out{in->request_id, MapRequest::Op::kList, in->map, in->formats, in->overwrite != 0, in->agent, in->utime};
  switch (in->op) {
    case map_request_t::LIST: return out;
    case map_request_t::SAVE: out.op = MapRequest::Op::kSave; break;
    case map_request_t::LOAD: out.op = MapRequest::Op::kLoad; break;
    default: return bad(Code::kBadRequest, "op must be SAVE, LIST or LOAD", in->request_id);
  }
  if (!is_name(out.map)) {
    return bad(Code::kBadName, std::string("a map's name is ") + kNameRule, out.id);
  }
  if (!are_formats(out)) {
    return bad(Code::kBadRequest, "formats must be of bt, ot and concord: SAVE each once, LOAD one or none", out.id);
  }
  if (!out.agent.empty() && !is_name(out.agent)) return bad_agent(out.id);
  return out;
}

}  // namespace concord
