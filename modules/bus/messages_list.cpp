// Translators of the list streams of zones and leases.

#include <concord/leases_t.hpp>
#include <concord/list_digest_t.hpp>
#include <concord/list_request_t.hpp>
#include <concord/zones_t.hpp>

#include "bus/translate_list.hpp"
#include "bus/translate_shape.hpp"

namespace concord {
namespace {

using wire::bad;

/// Of zones or leases: as many as there may be items.
constexpr std::int64_t kMaxParts = kMaxZones;
/// Of any list: what the longest takes, the label slots.
constexpr std::int64_t kMaxPartsOfAny = 8192;

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

}  // namespace

Bytes encode(const ListPart<Zone>& value, std::int64_t utime) {
  return wire::write_list(value, utime, &zones_t::zones, to_wire);
}
Bytes encode(const ListPart<Lease>& value, std::int64_t utime) {
  return wire::write_list(value, utime, &leases_t::leases, to_wire);
}

template <>
Decoded<ListPart<Zone>> decode<ListPart<Zone>>(std::span<const std::uint8_t> bytes) {
  return wire::read_list<Zone>(bytes, &zones_t::zones, kZone, kMaxParts, from_wire);
}

template <>
Decoded<ListPart<Lease>> decode<ListPart<Lease>>(std::span<const std::uint8_t> bytes) {
  return wire::read_list<Lease>(bytes, &leases_t::leases, kLease, kMaxParts, from_wire);
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
