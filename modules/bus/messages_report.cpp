// Translators of what the stack says: answers, agents, status.

#include <concord/agents_t.hpp>
#include <concord/answer_t.hpp>
#include <concord/downsampled_t.hpp>
#include <concord/frame_over_t.hpp>
#include <concord/map_list_t.hpp>
#include <concord/map_pose_t.hpp>
#include <concord/status_t.hpp>

#include "bus/translate.hpp"
#include "core/octomap_format.hpp"

namespace concord {
namespace {

using wire::bad;

constexpr std::int64_t kMaxFiles = 10'000;
constexpr std::int64_t kMaxFileName = 100;
constexpr std::int64_t kMaxAgents = 1024;
constexpr std::int64_t kMaxCounterName = 160;

agent_state_t to_wire(const AgentState& agent) {
  agent_state_t out;
  out.id = agent.id;
  out.kind = agent.kind;
  out.frame_id = agent.frame_id;
  out.weight = agent.weight;
  out.aligned = agent.aligned;
  out.T_map_agent = wire::to_wire(agent.T_map_agent);
  out.known = agent.known;
  out.occupied = agent.occupied;
  out.revision = agent.revision;
  out.synced = agent.synced;
  return out;
}

}  // namespace

Bytes encode(const FrameOver& value) {
  frame_over_t out;
  out.utime = value.utime;
  out.frame_id = value.frame_id;
  return wire::to_bytes(out);
}

template <>
Decoded<FrameOver> decode<FrameOver>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kNameLength)};
  const auto in = wire::from_bytes<frame_over_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  if (!is_name(in->frame_id)) return bad(Code::kBadFrame, "frame_id is not a name");
  return FrameOver{in->utime, in->frame_id};
}

Bytes encode(const MapPose& value) {
  map_pose_t out;
  out.utime = value.utime;
  out.agent = value.agent;
  out.T_map_base = wire::to_wire(value.T_map_base);
  return wire::to_bytes(out);
}

template <>
Decoded<MapPose> decode<MapPose>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kNameLength), fixed(wire::kTransformBytes)};
  const auto in = wire::from_bytes<map_pose_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  if (!is_name(in->agent)) return bad(Code::kBadName, "agent is not a name");
  const auto T = wire::from_wire(in->T_map_base);
  if (!T) return bad(T.error());
  return MapPose{in->utime, in->agent, *T};
}

Bytes encode(const Downsampled& value, std::int64_t utime) {
  downsampled_t out;
  out.utime = utime;
  out.request_id = value.id;
  out.agent = value.agent;
  out.frame_id = value.frame_id;
  out.resolution = value.resolution;
  out.part = value.part;
  out.parts = value.parts;
  wire::put_points(value.points, out);
  return wire::to_bytes(out);
}

template <>
Decoded<Downsampled> decode<Downsampled>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8),
                                          text(wire::kIdLength),
                                          text(wire::kNameLength),
                                          text(wire::kNameLength),
                                          fixed(8 + 4 + 4),
                                          count(10'000),
                                          array(4),
                                          array(4),
                                          array(4)};
  const auto in = wire::from_bytes<downsampled_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  if (in->part < 0 || in->parts < 1 || in->part >= in->parts) return bad(Code::kMalformed, "part is not one of parts");
  Downsampled out{in->request_id, in->agent, in->frame_id, in->resolution, in->part, in->parts, {}};
  out.points = wire::points_of<Eigen::Vector3f>(*in);
  if (!wire::all_finite(out.points)) return bad(Code::kNotFinite, "a point is not finite");
  return out;
}

Bytes encode(const MapList& value, std::int64_t utime) {
  map_list_t out;
  out.utime = utime;
  out.request_id = value.id;
  out.count = static_cast<std::int32_t>(value.files.size());
  for (const auto& [file, size] : value.files) {
    out.files.push_back(file);
    out.sizes.push_back(size);
  }
  return wire::to_bytes(out);
}

template <>
Decoded<MapList> decode<MapList>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kIdLength), count(kMaxFiles), texts(kMaxFileName),
                                          array(8)};
  const auto in = wire::from_bytes<map_list_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  MapList out{in->request_id, {}};
  for (std::size_t i = 0; i < in->files.size(); ++i) out.files.emplace_back(in->files[i], in->sizes[i]);
  return out;
}

Bytes encode(const Answer& value, std::int64_t utime) {
  answer_t out;
  out.utime = utime;
  out.request_id = value.id;
  out.process = value.process;
  out.ok = value.ok;
  out.code = value.code;
  out.message = wire::clipped(value.message);
  out.revision = value.revision;
  out.count = value.count;
  out.content = static_cast<std::int64_t>(value.content);
  out.parts = value.parts;
  out.part_count = static_cast<std::int32_t>(out.parts.size());
  return wire::to_bytes(out);
}

template <>
Decoded<Answer> decode<Answer>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8),
                                          text(wire::kIdLength),
                                          text(wire::kNameLength),
                                          fixed(1),
                                          text(wire::kNameLength),
                                          text(wire::kMessageLength),
                                          fixed(3 * 8),
                                          count(16),
                                          array(8)};
  const auto in = wire::from_bytes<answer_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  return Answer{in->request_id, in->process,  in->ok != 0, in->code,
                in->message,    in->revision, in->count,   static_cast<std::uint64_t>(in->content),
                in->parts};
}

Bytes encode(const AgentList& value) {
  agents_t out;
  out.utime = value.utime;
  out.resolution = value.resolution;
  out.count = static_cast<std::int32_t>(value.agents.size());
  for (const AgentState& agent : value.agents) out.agents.push_back(to_wire(agent));
  return wire::to_bytes(out);
}

template <>
Decoded<AgentList> decode<AgentList>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kRecord[] = {text(wire::kNameLength), text(wire::kNameLength), text(wire::kNameLength),
                                          fixed(4 + 1 + wire::kTransformBytes + 8 + 8 + 8 + 1)};
  static constexpr WireField kLayout[] = {fixed(8 + 8), count(kMaxAgents), records(kRecord)};
  const auto in = wire::from_bytes<agents_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  if (const auto fine = checked_resolution(in->resolution); !fine) return bad(fine.error());
  AgentList out{in->utime, in->resolution, {}};
  for (const agent_state_t& agent : in->agents) {
    const auto T = wire::from_wire(agent.T_map_agent);
    if (!T) return bad(T.error());
    out.agents.push_back({agent.id, agent.kind, agent.frame_id, agent.weight, agent.aligned != 0, *T, agent.known,
                          agent.occupied, agent.revision, agent.synced != 0});
  }
  return out;
}

Bytes encode(const ProcessStatus& value) {
  status_t out;
  out.utime = value.utime;
  out.process = value.process;
  out.boot_id = value.boot_id;
  out.count = static_cast<std::int32_t>(value.counters.size());
  for (const auto& [name, number] : value.counters) {
    out.names.push_back(name);
    out.values.push_back(number);
  }
  return wire::to_bytes(out);
}

template <>
Decoded<ProcessStatus> decode<ProcessStatus>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8),    text(wire::kNameLength), fixed(8),
                                          count(1024), texts(kMaxCounterName),  array(8)};
  const auto in = wire::from_bytes<status_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  ProcessStatus out{in->utime, in->process, in->boot_id, {}};
  for (std::size_t i = 0; i < in->names.size(); ++i) out.counters[in->names[i]] = in->values[i];
  return out;
}

void answer(Bus& bus, const Answer& value) { bus.publish(kAnswers, encode(value, bus.now())); }

}  // namespace concord
