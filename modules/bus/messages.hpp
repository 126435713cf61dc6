#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/counters.hpp"
#include "core/requests.hpp"

namespace concord {

/// Messages that exist only between processes, as values. Those that people and robots speak are in core/requests.hpp.

/// See stream.md.
struct BrickPacket {
  std::int64_t utime = 0;
  std::int64_t boot_id = 0;
  std::string frame_id;
  double resolution = 0;
  std::int64_t first_version = 0;  ///< the packet covers [first_version, last_version]
  std::int64_t last_version = 0;
  std::int32_t count = 0;
  Bytes data;  ///< `count` bricks, see stream.md; checked against the packet's checksum
  std::int64_t incarnation = 0;
};

struct BrickDigest {
  std::int64_t utime = 0;
  std::int64_t boot_id = 0;
  std::string frame_id;
  double resolution = 0;
  std::int64_t revision = 0;
  std::int64_t brick_count = 0;
  std::uint64_t content = 0;  ///< core/brick_map.hpp: digest()
  std::int64_t incarnation = 0;
};

struct BrickRequest {
  std::int64_t boot_id = 0;
  std::vector<std::pair<std::int64_t, std::int64_t>> intervals;  ///< of versions, both ends included
};

struct OctomapMessage {
  std::int64_t utime = 0;
  std::string frame_id;
  double resolution = 0;
  bool binary = true;
  Bytes data;  ///< tree without file header
};

struct CloudMessage {
  std::int64_t utime = 0;
  std::int64_t boot_id = 0;
  std::int64_t sequence = 0;
  std::string frame_id;
  std::optional<Transform> T_agent_sensor;
  double max_range = 0;
  std::vector<Eigen::Vector3f> points;  ///< agent's frame; may hold NaN, as sensors send it
};

/// The agent's id stands in the channel: out/frame_over/AGENT.
struct FrameOver {
  std::int64_t utime = 0;
  std::string frame_id;
};

struct MapPose {
  std::int64_t utime = 0;
  std::string agent;
  Transform T_map_base = Transform::Identity();
};

struct Downsampled {
  std::string id;
  std::string agent;
  std::string frame_id;
  double resolution = 0;
  std::int32_t part = 0, parts = 1;
  std::vector<Eigen::Vector3f> points;
};

struct MapList {
  std::string id;
  std::vector<std::pair<std::string, std::int64_t>> files;  ///< name with extension, bytes
};

struct AgentList {
  std::int64_t utime = 0;
  std::vector<AgentState> agents;
};

struct ProcessStatus {
  std::int64_t utime = 0;
  std::string process;
  std::int64_t boot_id = 0;
  std::map<std::string, std::int64_t> counters;
};

/// Value to wire bytes. `utime` stamps messages whose value has no time of its own.
[[nodiscard]] Bytes encode(const BrickPacket& value);
[[nodiscard]] Bytes encode(const BrickDigest& value);
[[nodiscard]] Bytes encode(const BrickRequest& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const OctomapMessage& value);
[[nodiscard]] Bytes encode(const CloudMessage& value);
[[nodiscard]] Bytes encode(const AgentPose& value);
[[nodiscard]] Bytes encode(const FrameOver& value);
[[nodiscard]] Bytes encode(const MapPose& value);
[[nodiscard]] Bytes encode(const TransformRequest& value, std::int64_t utime);
/// Voxels travel as boxes; `resolution` is the map's.
[[nodiscard]] Bytes encode(const EditRequest& value, double resolution);
[[nodiscard]] Bytes encode(const AgentRequest& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const DownsampleRequest& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const Downsampled& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const MapRequest& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const MapList& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const PathRequest& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const Path& value);
[[nodiscard]] Bytes encode(const Answer& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const AgentList& value);
[[nodiscard]] Bytes encode(const ProcessStatus& value);

/// A message that cannot be used, with the asker's id where that much could be read, so that the refusal reaches them.
struct BadMessage {
  Error error;
  std::string id;
};

template <class T>
using Decoded = tl::expected<T, BadMessage>;

/// Wire bytes to a checked value: everything core/requests.hpp promises holds. Defined for each value type above.
template <class T>
[[nodiscard]] Decoded<T> decode(std::span<const std::uint8_t> bytes);

template <>
Decoded<BrickPacket> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<BrickDigest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<BrickRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<OctomapMessage> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<CloudMessage> decode(std::span<const std::uint8_t> bytes);
/// The agent's id stands in the channel, not in the message: the subscriber fills it in.
template <>
Decoded<AgentPose> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<FrameOver> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<MapPose> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<TransformRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<AgentRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<DownsampleRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<Downsampled> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<MapRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<MapList> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<PathRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<Path> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<Answer> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<AgentList> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<ProcessStatus> decode(std::span<const std::uint8_t> bytes);

/// An edit's indices only mean something at the map's resolution, which the receiver knows.
[[nodiscard]] Decoded<EditRequest> decode_edit(std::span<const std::uint8_t> bytes, double resolution);

/// Answers a request on `kAnswers`.
inline const std::string kAnswers = "out/answer";
void answer(Bus& bus, const Answer& value);

/// How many messages of a type may wait for a busy process. LCM counts messages, not bytes: the largest kinds get few.
template <class T>
inline constexpr int kQueuedOf = Bus::kQueued;
template <>
inline constexpr int kQueuedOf<OctomapMessage> = 4;
template <>
inline constexpr int kQueuedOf<CloudMessage> = 32;

/// Subscribes to a message type: decodes, hands on what is good, counts what is not and refuses it to its asker.
/// `process` names who refuses.
template <class T, class Handle>
void listen(Bus& bus, Counters& counters, const std::string& process, const std::string& channel_regex, Handle handle) {
  const auto hear = [&bus, &counters, process, handle](const std::string& channel,
                                                       std::span<const std::uint8_t> bytes) {
    Decoded<T> value = decode<T>(bytes);
    if (value) return handle(channel, std::move(*value));
    const auto& [error, id] = value.error();
    counters.refused(channel, error);
    if (!id.empty()) answer(bus, {id, process, false, name(error.code), error.message, 0, 0});
  };
  bus.subscribe(channel_regex, hear, kQueuedOf<T>);
}

}  // namespace concord
