#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/counters.hpp"
#include "core/alignment.hpp"
#include "core/corrections.hpp"
#include "core/requests.hpp"

namespace concord {

/// Messages that exist only between processes, as values. Those that people and robots speak are in core/requests.hpp,
/// core/corrections.hpp and core/alignment.hpp.

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
  double resolution = 0;  ///< edge of a voxel everywhere in this site, metres
  std::vector<AgentState> agents;
};

struct ProcessStatus {
  std::int64_t utime = 0;
  std::string process;
  std::int64_t boot_id = 0;
  std::map<std::string, std::int64_t> counters;
};

/// What is sent in parts: bytes of items in one, unless one item alone is more, so that a frame on the wire holds it.
inline constexpr std::size_t kPartBytes = 1200;
inline constexpr std::size_t kMostInPart = 64;

/// A part of the answer to a HistoryRequest.
struct HistoryPart {
  std::string id;  ///< the request's
  std::int32_t part = 0, parts = 1;
  std::vector<Operation> operations;  ///< in the order of their revisions
};

/// A part of the answer to a ConflictRequest.
struct ConflictList {
  std::string id;  ///< the request's
  std::int32_t part = 0, parts = 1;
  std::int64_t regions_in_all = 0, voxels_in_all = 0;  ///< in the whole map
  std::vector<ConflictRegion> regions;                 ///< the most voxels first
};

/// Divides an answer into parts that each fit one frame on the wire, unless one item alone does not. At least one part.
[[nodiscard]] std::vector<HistoryPart> in_parts(HistoryPart whole);
[[nodiscard]] std::vector<ConflictList> in_parts(ConflictList whole);

/// A part of a list of zones or leases, see stream.md.
template <class T>
struct ListPart {
  std::uint64_t content = 0;  ///< of the whole list
  std::int32_t part = 0, parts = 1;
  std::vector<T> items;
  Bytes encoded;  ///< the items as they stood in the message: what `content` is the hash of. Only what is read has it
};

struct ListDigest {
  std::uint64_t content = 0;
  std::int32_t parts = 0;  ///< 0: the list is empty
};

struct ListRequest {
  std::uint64_t content = 0;
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
[[nodiscard]] Bytes encode(const EditRequest& value);
[[nodiscard]] Bytes encode(const UndoRequest& value);
[[nodiscard]] Bytes encode(const ZoneRequest& value);
[[nodiscard]] Bytes encode(const LeaseRequest& value);
[[nodiscard]] Bytes encode(const WeightRequest& value);
[[nodiscard]] Bytes encode(const LocaliseRequest& value);
[[nodiscard]] Bytes encode(const HistoryRequest& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const HistoryPart& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const ConflictRequest& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const ConflictList& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const ListPart<Zone>& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const ListPart<Lease>& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const ListDigest& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const ListRequest& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const AgentRequest& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const DownsampleRequest& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const Downsampled& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const MapRequest& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const MapList& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const PathRequest& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const PathWatch& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const Path& value);
[[nodiscard]] Bytes encode(const AlignRequest& value);
[[nodiscard]] Bytes encode(const AlignDecision& value);
[[nodiscard]] Bytes encode(const AlignResult& value);
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

/// Wire bytes to a checked value: everything core/requests.hpp, core/corrections.hpp and core/alignment.hpp promise
/// holds. Defined for each value type above.
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
Decoded<EditRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<UndoRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<ZoneRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<LeaseRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<WeightRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<LocaliseRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<HistoryRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<HistoryPart> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<ConflictRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<ConflictList> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<ListPart<Zone>> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<ListPart<Lease>> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<ListDigest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<ListRequest> decode(std::span<const std::uint8_t> bytes);
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
Decoded<PathWatch> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<Path> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<AlignRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<AlignDecision> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<AlignResult> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<Answer> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<AgentList> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<ProcessStatus> decode(std::span<const std::uint8_t> bytes);

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
template <>
inline constexpr int kQueuedOf<EditRequest> = 128;  ///< of up to 1.6 MB
template <class T>
inline constexpr int kQueuedOf<ListPart<T>> = 2048;  ///< two whole lists

/// What `listen` subscribes.
template <class T, class Handle>
[[nodiscard]] Bus::Handler hearing(Bus& bus, Counters& counters, const std::string& process, Handle handle) {
  return [&bus, &counters, process, handle](const std::string& channel, std::span<const std::uint8_t> bytes) {
    Decoded<T> value = decode<T>(bytes);
    if (value) return handle(channel, std::move(*value));
    const auto& [error, id] = value.error();
    counters.refused(channel, error);
    if (!id.empty()) answer(bus, {id, process, false, name(error.code), error.message, 0, 0});
  };
}

/// Subscribes to a message type: decodes, hands on what is good, counts what is not and refuses it to its asker.
/// `process` names who refuses. Until `owner` has gone; without one for as long as the bus lives.
template <class T, class Handle>
void listen(Bus& bus, Counters& counters, const std::string& process, const std::string& channel_regex, Handle handle) {
  bus.subscribe(channel_regex, hearing<T>(bus, counters, process, handle), kQueuedOf<T>);
}
template <class T, class Handle>
void listen(Bus& bus, Counters& counters, const std::string& process, const std::string& channel_regex, Handle handle,
            Bus::Owner owner) {
  bus.subscribe(channel_regex, hearing<T>(bus, counters, process, handle), kQueuedOf<T>, std::move(owner));
}

}  // namespace concord
