// Translators of the list streams of zones and leases.

#include <concord/leases_t.hpp>
#include <concord/list_digest_t.hpp>
#include <concord/list_request_t.hpp>
#include <concord/zones_t.hpp>

#include "bus/translate_shape.hpp"

namespace concord {
namespace {

using wire::bad;

/// Of zones or leases: as many as there may be items.
constexpr std::int64_t kMaxParts = kMaxZones;
/// Of any list: what the longest takes, the label slots.
constexpr std::int64_t kMaxPartsOfAny = 8192;
/// Fingerprint, utime, content, part, parts, count.
constexpr std::size_t kBeforeItems = 8 + 8 + 8 + 4 + 4 + 4;

/// What was once taken from a person is said as it is.
Result<std::string> line(const std::string& text) {
  if (is_line(text)) return text;
  return refuse(Code::kBadRequest, "a text has control characters");
}

zone_t to_wire(const Zone& zone) {
  zone_t out{};
  out.name = zone.name;
  out.kind = wire::to_wire(zone.kind);
  out.volume = wire::to_wire(zone.volume);
  out.margin = zone.margin;
  out.cost = zone.cost;
  out.T_map_zone = wire::to_wire(zone.T_map_zone);
  out.author = zone.author;
  out.utime = zone.utime;
  out.revision = zone.revision;
  return out;
}

Decoded<Zone> from_wire(const zone_t& in) {
  wire::Filling<Zone> out({}, {});
  out.take(&Zone::name, wire::kept_title_of(in.name));
  out.take(&Zone::kind, wire::zone_kind(in.kind));
  out.take(&Zone::volume, wire::volume_from_wire(in.volume));
  out.take(&Zone::margin, wire::margin_of(in));
  out.take(&Zone::cost, Result<int>(in.cost));
  out.take(&Zone::T_map_zone, wire::from_wire(in.T_map_zone));
  out.take(&Zone::author, line(in.author));
  out.take(&Zone::utime, Result<std::int64_t>(in.utime));
  out.take(&Zone::revision, wire::not_negative(in.revision, "revision"));
  return out.done();
}

lease_t to_wire(const Lease& lease) {
  lease_t out{};
  out.lease_id = lease.id;
  out.author = lease.author;
  out.volume = wire::to_wire(lease.volume);
  out.T_map_lease = wire::to_wire(lease.T_map_lease);
  out.until = lease.until;
  return out;
}

Decoded<Lease> from_wire(const lease_t& in) {
  if (!is_request_id(in.lease_id)) return wire::bad_id();
  wire::Filling<Lease> out({}, {});
  out.take(&Lease::id, Result<std::string>(in.lease_id));
  out.take(&Lease::author, line(in.author));
  out.take(&Lease::volume, wire::volume_from_wire(in.volume));
  out.take(&Lease::T_map_lease, wire::from_wire(in.T_map_lease));
  out.take(&Lease::until, Result<std::int64_t>(in.until));
  return out.done();
}

constexpr WireField kZone[] = {
    text(wire::kTitleLength), fixed(1),    wire::kVolume, fixed(8 + 4 + wire::kTransformBytes),
    text(wire::kIdLength),    fixed(8 + 8)};
constexpr WireField kLease[] = {text(wire::kIdLength), text(wire::kIdLength), wire::kVolume,
                                fixed(wire::kTransformBytes + 8)};

auto& items_in(zones_t& message) { return message.zones; }
auto& items_in(leases_t& message) { return message.leases; }

template <class Lcm, class T>
Bytes write(const ListPart<T>& value, std::int64_t utime) {
  Lcm out;
  out.utime = utime;
  out.content = static_cast<std::int64_t>(value.content);
  out.part = value.part;
  out.parts = value.parts;
  out.count = static_cast<std::int32_t>(value.items.size());
  for (const T& item : value.items) items_in(out).push_back(to_wire(item));
  return wire::to_bytes(out);
}

template <class Lcm, class T>
Decoded<ListPart<T>> read(std::span<const std::uint8_t> bytes, std::span<const WireField> item) {
  const WireField layout[] = {fixed(8 + 8 + 4 + 4), count(kMostInPart), records(item)};
  auto in = wire::from_bytes<Lcm>(bytes, layout);
  if (!in) return bad(in.error());
  if (auto fine = wire::check_part(in->part, in->parts, kMaxParts); !fine) return bad(fine.error());
  ListPart<T> out{static_cast<std::uint64_t>(in->content), in->part, in->parts, {}, {}};
  for (const auto& one : items_in(*in)) {
    auto value = from_wire(one);
    if (!value) return tl::unexpected(value.error());
    out.items.push_back(std::move(*value));
  }
  const auto encoded = bytes.subspan(kBeforeItems);
  out.encoded.assign(encoded.begin(), encoded.end());
  return out;
}

}  // namespace

Bytes encode(const ListPart<Zone>& value, std::int64_t utime) { return write<zones_t>(value, utime); }
Bytes encode(const ListPart<Lease>& value, std::int64_t utime) { return write<leases_t>(value, utime); }

template <>
Decoded<ListPart<Zone>> decode<ListPart<Zone>>(std::span<const std::uint8_t> bytes) {
  return read<zones_t, Zone>(bytes, kZone);
}

template <>
Decoded<ListPart<Lease>> decode<ListPart<Lease>>(std::span<const std::uint8_t> bytes) {
  return read<leases_t, Lease>(bytes, kLease);
}

Bytes encode(const ListDigest& value, std::int64_t utime) {
  list_digest_t out;
  out.utime = utime;
  out.content = static_cast<std::int64_t>(value.content);
  out.parts = value.parts;
  return wire::to_bytes(out);
}

template <>
Decoded<ListDigest> decode<ListDigest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8 + 8 + 4)};
  const auto in = wire::from_bytes<list_digest_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  if (in->parts < 0) return bad(Code::kMalformed, "a list has a negative number of parts");
  if (in->parts > kMaxPartsOfAny) {
    return bad(Code::kTooLarge, "a list has over " + std::to_string(kMaxPartsOfAny) + " parts");
  }
  return ListDigest{static_cast<std::uint64_t>(in->content), in->parts};
}

Bytes encode(const ListRequest& value, std::int64_t utime) {
  list_request_t out;
  out.utime = utime;
  out.content = static_cast<std::int64_t>(value.content);
  return wire::to_bytes(out);
}

template <>
Decoded<ListRequest> decode<ListRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8 + 8)};
  const auto in = wire::from_bytes<list_request_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  return ListRequest{static_cast<std::uint64_t>(in->content)};
}

}  // namespace concord
