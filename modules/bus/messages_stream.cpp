// Translators of what carries maps: brick streams, whole octomaps, clouds.

#include <xxhash.h>
#include <concord/brick_digest_t.hpp>
#include <concord/brick_packet_t.hpp>
#include <concord/brick_request_t.hpp>
#include <concord/cloud_t.hpp>
#include <concord/map_edits_t.hpp>
#include <concord/octomap_t.hpp>

#include "bus/messages_map.hpp"
#include "bus/translate.hpp"

namespace concord {
namespace {

constexpr std::int64_t kMaxPacketBytes = 60'000;
constexpr std::int64_t kMaxIntervals = 4096;
constexpr std::int64_t kMaxVersion = std::int64_t{1} << 60;  ///< sums of a few do not overflow
constexpr std::int64_t kMaxOctomapBytes = 200'000'000;
constexpr std::int64_t kMaxCloudPoints = 2'000'000;

using wire::bad;

Result<void> check_frame(const std::string& frame_id) {
  if (!is_name(frame_id)) return refuse(Code::kBadFrame, std::string("frame_id must be ") + kNameRule);
  return {};
}

Result<void> check_resolution(double resolution) {
  if (!(resolution >= 0.001 && resolution <= 10.0)) {
    return refuse(Code::kBadResolution, "resolution must lie between 0.001 and 10 m");
  }
  return {};
}

bool is_interval(std::int64_t first, std::int64_t last) { return first >= 1 && first <= last && last <= kMaxVersion; }

std::int32_t checksum(std::span<const std::uint8_t> data) {
  return static_cast<std::int32_t>(XXH32(data.data(), data.size(), 0));
}

}  // namespace

Bytes encode(const BrickPacket& value) {
  brick_packet_t out;
  out.utime = value.utime;
  out.boot_id = value.boot_id;
  out.incarnation = value.incarnation;
  out.frame_id = value.frame_id;
  out.submap_id = 0;
  out.resolution = value.resolution;
  out.first_version = value.first_version;
  out.last_version = value.last_version;
  out.count = value.count;
  out.checksum = checksum(value.data);
  out.size = static_cast<std::int32_t>(value.data.size());
  out.data = value.data;
  return wire::to_bytes(out);
}

template <>
Decoded<BrickPacket> decode<BrickPacket>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(24), text(wire::kNameLength), fixed(4 + 8 + 8 + 8 + 4 + 4),
                                          count(kMaxPacketBytes), array(1)};
  auto in = wire::from_bytes<brick_packet_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  if (auto ok = check_frame(in->frame_id); !ok) return bad(ok.error());
  if (auto ok = check_resolution(in->resolution); !ok) return bad(ok.error());
  if (!is_interval(in->first_version, in->last_version) || in->boot_id < 1 || in->count < 0) {
    return bad(Code::kMalformed, "versions and boot_id of a packet must be positive and in order");
  }
  if (in->submap_id != 0) return bad(Code::kBadRequest, "submap_id must be 0");
  if (checksum(in->data) != in->checksum) return bad(Code::kMalformed, "checksum of a brick packet is wrong");
  return BrickPacket{in->utime,        in->boot_id, in->frame_id,        in->resolution, in->first_version,
                     in->last_version, in->count,   std::move(in->data), in->incarnation};
}

Bytes encode(const BrickDigest& value) {
  brick_digest_t out;
  out.utime = value.utime;
  out.boot_id = value.boot_id;
  out.incarnation = value.incarnation;
  out.frame_id = value.frame_id;
  out.submap_id = 0;
  out.resolution = value.resolution;
  out.revision = value.revision;
  out.brick_count = value.brick_count;
  out.content = static_cast<std::int64_t>(value.content);
  return wire::to_bytes(out);
}

template <>
Decoded<BrickDigest> decode<BrickDigest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(24), text(wire::kNameLength), fixed(4 + 8 + 8 + 8 + 8)};
  const auto in = wire::from_bytes<brick_digest_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  // An empty frame says that the stream has ended.
  if (!in->frame_id.empty()) {
    if (auto ok = check_frame(in->frame_id); !ok) return bad(ok.error());
  }
  if (auto ok = check_resolution(in->resolution); !ok) return bad(ok.error());
  if (in->boot_id < 1 || in->brick_count < 0 || in->brick_count > in->revision || in->revision > kMaxVersion) {
    return bad(Code::kMalformed, "a digest counts more bricks than versions, or has no boot_id");
  }
  if (in->submap_id != 0) return bad(Code::kBadRequest, "submap_id must be 0");
  return BrickDigest{in->utime,
                     in->boot_id,
                     in->frame_id,
                     in->resolution,
                     in->revision,
                     in->brick_count,
                     static_cast<std::uint64_t>(in->content),
                     in->incarnation};
}

Bytes encode(const MapEdits& value) {
  map_edits_t out;
  out.utime = value.utime;
  out.boot_id = value.boot_id;
  out.edit_revision = value.edit_revision;
  out.map_revision = value.map_revision;
  return wire::to_bytes(out);
}

template <>
Decoded<MapEdits> decode<MapEdits>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(32)};
  const auto in = wire::from_bytes<map_edits_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  if (in->boot_id < 1 || in->edit_revision < 0 || in->map_revision < 0) {
    return bad(Code::kMalformed, "revisions of the map's edits must not be negative, and come with a boot_id");
  }
  return MapEdits{in->utime, in->boot_id, in->edit_revision, in->map_revision};
}

Bytes encode(const BrickRequest& value, std::int64_t utime) {
  brick_request_t out;
  out.utime = utime;
  out.boot_id = value.boot_id;
  out.count = static_cast<std::int32_t>(value.intervals.size());
  for (const auto& [first, last] : value.intervals) {
    out.first_version.push_back(first);
    out.last_version.push_back(last);
  }
  return wire::to_bytes(out);
}

template <>
Decoded<BrickRequest> decode<BrickRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(16), count(kMaxIntervals), array(8), array(8)};
  const auto in = wire::from_bytes<brick_request_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  BrickRequest out{in->boot_id, {}};
  for (std::size_t i = 0; i < in->first_version.size(); ++i) {
    if (!is_interval(in->first_version[i], in->last_version[i])) {
      return bad(Code::kMalformed, "an interval of versions is out of order");
    }
    out.intervals.emplace_back(in->first_version[i], in->last_version[i]);
  }
  return out;
}

Bytes encode(const OctomapMessage& value) {
  octomap_t out;
  out.utime = value.utime;
  out.frame_id = value.frame_id;
  out.resolution = value.resolution;
  out.binary = value.binary;
  out.size = static_cast<std::int32_t>(value.data.size());
  out.data = value.data;
  return wire::to_bytes(out);
}

template <>
Decoded<OctomapMessage> decode<OctomapMessage>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kNameLength), fixed(8 + 1), count(kMaxOctomapBytes),
                                          array(1)};
  auto in = wire::from_bytes<octomap_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  if (auto ok = check_frame(in->frame_id); !ok) return bad(ok.error());
  if (auto ok = check_resolution(in->resolution); !ok) return bad(ok.error());
  return OctomapMessage{in->utime, in->frame_id, in->resolution, in->binary != 0, std::move(in->data)};
}

Bytes encode(const CloudMessage& value) {
  cloud_t out;
  out.utime = value.utime;
  out.boot_id = value.boot_id;
  out.sequence = value.sequence;
  out.frame_id = value.frame_id;
  out.has_sensor_pose = value.T_agent_sensor.has_value();
  out.T_agent_sensor = wire::to_wire(value.T_agent_sensor.value_or(Transform::Identity()));
  out.max_range = value.max_range;
  wire::put_points(value.points, out);
  return wire::to_bytes(out);
}

template <>
Decoded<CloudMessage> decode<CloudMessage>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(24),
                                          text(wire::kNameLength),
                                          fixed(1 + wire::kTransformBytes + 8),
                                          count(kMaxCloudPoints),
                                          array(4),
                                          array(4),
                                          array(4)};
  const auto in = wire::from_bytes<cloud_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  if (auto ok = check_frame(in->frame_id); !ok) return bad(ok.error());
  if (in->boot_id < 1) return bad(Code::kBadRequest, "boot_id is the time of the sender's start");
  if (in->sequence < 0) return bad(Code::kBadRequest, "sequence counts up from 0");
  if (!(in->max_range >= 0 && in->max_range <= 1000)) {
    return bad(Code::kBadRequest, "max_range must lie between 0 (no limit) and 1000 m");
  }
  CloudMessage out{in->utime, in->boot_id, in->sequence, in->frame_id, std::nullopt, in->max_range, {}};
  if (in->has_sensor_pose) {
    auto pose = wire::from_wire(in->T_agent_sensor);
    if (!pose) return bad(pose.error());
    out.T_agent_sensor = *pose;
  }
  out.points = wire::points_of<Eigen::Vector3f>(*in);
  return out;
}

}  // namespace concord
