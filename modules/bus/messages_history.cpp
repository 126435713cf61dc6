// Translators of who did what, and of what is in conflict.

#include <concord/conflict_list_t.hpp>
#include <concord/conflict_request_t.hpp>
#include <concord/history_request_t.hpp>
#include <concord/history_t.hpp>

#include "bus/pack.hpp"
#include "bus/translate.hpp"

namespace concord {
namespace {

using wire::bad;
using Kind = Operation::Kind;

constexpr std::int64_t kMaxParts = 10'000;
constexpr std::int64_t kMaxClaims = 1024;
constexpr int kMostOperations = 10'000;
/// Of one tile of the map.
constexpr std::int32_t kMaxVoxelsOfRegion = 32 * 32 * 32;

constexpr std::int8_t to_wire(Kind kind) { return static_cast<std::int8_t>(static_cast<int>(kind) + 1); }
static_assert(to_wire(Kind::kAdd) == operation_t::ADD && to_wire(Kind::kDelete) == operation_t::DELETE &&
              to_wire(Kind::kMove) == operation_t::MOVE && to_wire(Kind::kUndo) == operation_t::UNDO &&
              to_wire(Kind::kRedo) == operation_t::REDO && to_wire(Kind::kZoneAdd) == operation_t::ZONE_ADD &&
              to_wire(Kind::kZoneChange) == operation_t::ZONE_CHANGE &&
              to_wire(Kind::kZoneDelete) == operation_t::ZONE_DELETE &&
              to_wire(Kind::kTransform) == operation_t::TRANSFORM && to_wire(Kind::kWeight) == operation_t::WEIGHT);

Result<Kind> kind_of(std::int8_t kind) {
  if (kind >= 1 && kind <= static_cast<std::int8_t>(kOperationNames.size())) return static_cast<Kind>(kind - 1);
  return refuse(Code::kBadRequest, "kind is none of operation_t's");
}

Result<std::optional<Kind>> any_kind_of(std::int8_t kind) {
  if (kind == 0) return std::optional<Kind>();
  return kind_of(kind).map([](Kind known) { return std::optional<Kind>(known); });
}

/// Also of what is asked for: it may have been made when more was taken for a name than is now.
Result<std::string> line(const std::string& text, const char* what) {
  if (is_line(text)) return text;
  return refuse(Code::kBadRequest, std::string(what) + " must be one line of at most 80 bytes");
}

Result<int> most_of(std::int32_t most, int highest) {
  if (most >= 1 && most <= highest) return most;
  return refuse(Code::kBadRequest, "most must lie between 1 and " + std::to_string(highest));
}

void put_bounds(VoxelIndex min, VoxelIndex max, auto& out) {
  const std::int32_t low[] = {min.x, min.y, min.z}, high[] = {max.x, max.y, max.z};
  for (int i = 0; i < 3; ++i) {
    out.min[i] = low[i];
    out.max[i] = high[i];
  }
}

template <class Lcm>
Result<void> check_bounds(const Lcm& in) {
  const VoxelIndex min{in.min[0], in.min[1], in.min[2]}, max{in.max[0], in.max[1], in.max[2]};
  if (!in_bounds(min) || !in_bounds(max)) return refuse(Code::kOutOfBounds, "a voxel lies beyond the map's bounds");
  if (min.x <= max.x && min.y <= max.y && min.z <= max.z) return {};
  return refuse(Code::kMalformed, "the lowest voxel lies above the highest");
}

VoxelIndex voxel(const std::int32_t (&index)[3]) { return {index[0], index[1], index[2]}; }

operation_t to_wire(const Operation& operation) {
  operation_t out;
  out.revision = operation.revision;
  out.id = operation.id;
  out.author = operation.author;
  out.utime = operation.utime;
  out.kind = to_wire(operation.kind);
  out.subject = operation.subject;
  out.count = operation.count;
  out.active = operation.active;
  put_bounds(operation.min, operation.max, out);
  return out;
}

Decoded<Operation> from_wire(const operation_t& in) {
  wire::Filling<Operation> out({}, {});
  out.take(&Operation::revision, wire::not_negative(in.revision, "revision"));
  out.take(&Operation::id, line(in.id, "id"));
  out.take(&Operation::author, line(in.author, "author"));
  out.take(&Operation::utime, Result<std::int64_t>(in.utime));
  out.take(&Operation::kind, kind_of(in.kind));
  out.take(&Operation::subject, line(in.subject, "subject"));
  out.take(&Operation::count, wire::not_negative(in.count, "count"));
  out.take(&Operation::active, Result<bool>(in.active != 0));
  out.require(check_bounds(in));
  out.take(&Operation::min, Result<VoxelIndex>(voxel(in.min)));
  out.take(&Operation::max, Result<VoxelIndex>(voxel(in.max)));
  return out.done();
}

conflict_region_t to_wire(const ConflictRegion& region) {
  conflict_region_t out;
  put_bounds(region.min, region.max, out);
  out.voxels = region.voxels;
  out.count = static_cast<std::int32_t>(region.claims.size());
  for (const auto& [agent, occupied, free] : region.claims) {
    auto& claim = out.claims.emplace_back();
    claim.agent = agent;
    claim.occupied = occupied;
    claim.free = free;
  }
  return out;
}

Decoded<ConflictRegion> from_wire(const conflict_region_t& in) {
  if (auto fine = check_bounds(in); !fine) return bad(fine.error());
  if (in.voxels < 1 || in.voxels > kMaxVoxelsOfRegion)
    return bad(Code::kMalformed, "a tile of the map has fewer voxels than this region");
  ConflictRegion out{voxel(in.min), voxel(in.max), in.voxels, {}};
  for (const claim_t& claim : in.claims) {
    if (const auto agent = wire::agent_of(claim.agent); !agent) return bad(agent.error());
    const auto within = [&](std::int32_t voxels) { return voxels >= 0 && voxels <= in.voxels; };
    if (!within(claim.occupied) || !within(claim.free)) {
      return bad(Code::kMalformed, "an agent claims more voxels than there are");
    }
    out.claims.push_back({claim.agent, claim.occupied, claim.free});
  }
  return out;
}

/// What both answers have in common on the wire.
template <class Lcm, class Part, class Items>
Lcm answer_part(const Part& part, std::int64_t utime, const Items& items, auto Lcm::*wire_items) {
  Lcm out;
  out.utime = utime;
  out.request_id = part.id;
  out.part = part.part;
  out.parts = part.parts;
  out.count = static_cast<std::int32_t>(items.size());
  for (const auto& item : items) (out.*wire_items).push_back(to_wire(item));
  return out;
}

template <class Part, class Items, class Lcm, class WireItems>
Decoded<Part> read_part(const Lcm& in, WireItems Lcm::*wire_items, Items Part::*items) {
  if (auto fine = wire::check_part(in.part, in.parts, kMaxParts); !fine) return bad(fine.error());
  Part out;
  out.id = in.request_id;
  out.part = in.part;
  out.parts = in.parts;
  for (const auto& item : in.*wire_items) {
    auto value = from_wire(item);
    if (!value) return tl::unexpected(value.error());
    (out.*items).push_back(std::move(*value));
  }
  return out;
}

/// At least one part.
template <class Part, class Items>
std::vector<Part> divide(Part whole, Items Part::*items) {
  const Items all = std::exchange(whole.*items, {});
  auto packed = pack(all, [](const auto& item) { return static_cast<std::size_t>(to_wire(item).getEncodedSize()); });
  if (packed.empty()) packed.emplace_back();
  std::vector<Part> parts(packed.size(), whole);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].*items = std::move(packed[i]);
    parts[i].part = static_cast<std::int32_t>(i);
    parts[i].parts = static_cast<std::int32_t>(parts.size());
  }
  return parts;
}

}  // namespace

std::vector<HistoryPart> in_parts(HistoryPart whole) { return divide(std::move(whole), &HistoryPart::operations); }
std::vector<ConflictList> in_parts(ConflictList whole) { return divide(std::move(whole), &ConflictList::regions); }

Bytes encode(const HistoryRequest& value, std::int64_t utime) {
  history_request_t out;
  out.utime = utime;
  out.request_id = value.id;
  out.author = value.author;
  out.subject = value.subject;
  out.kind = value.kind ? to_wire(*value.kind) : std::int8_t{0};
  out.since = value.since;
  out.until = value.until;
  out.after_revision = value.after_revision;
  out.most = value.most;
  return wire::to_bytes(out);
}

template <>
Decoded<HistoryRequest> decode<HistoryRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kIdLength), text(wire::kIdLength), text(wire::kIdLength),
                                          fixed(1 + 8 + 8 + 8 + 4)};
  const auto in = wire::request_from_bytes<history_request_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  wire::Filling<HistoryRequest> out({}, in->request_id);
  out.take(&HistoryRequest::id, Result<std::string>(in->request_id));
  out.take(&HistoryRequest::author, line(in->author, "author"));
  out.take(&HistoryRequest::subject, line(in->subject, "subject"));
  out.take(&HistoryRequest::kind, any_kind_of(in->kind));
  out.take(&HistoryRequest::since, wire::not_negative(in->since, "since"));
  out.take(&HistoryRequest::until, wire::not_negative(in->until, "until"));
  out.take(&HistoryRequest::after_revision, wire::not_negative(in->after_revision, "after_revision"));
  out.take(&HistoryRequest::most, most_of(in->most, kMostOperations));
  return out.done();
}

Bytes encode(const HistoryPart& value, std::int64_t utime) {
  return wire::to_bytes(answer_part<history_t>(value, utime, value.operations, &history_t::operations));
}

template <>
Decoded<HistoryPart> decode<HistoryPart>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kOperation[] = {fixed(8),     text(wire::kIdLength), text(wire::kIdLength),
                                             fixed(8 + 1), text(wire::kIdLength), fixed(8 + 1 + 24)};
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kIdLength), fixed(4 + 4), count(kMostInPart),
                                          records(kOperation)};
  const auto in = wire::from_bytes<history_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  return read_part(*in, &history_t::operations, &HistoryPart::operations);
}

Bytes encode(const ConflictRequest& value, std::int64_t utime) {
  conflict_request_t out;
  out.utime = utime;
  out.request_id = value.id;
  out.most = value.most;
  return wire::to_bytes(out);
}

template <>
Decoded<ConflictRequest> decode<ConflictRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kIdLength), fixed(4)};
  const auto in = wire::request_from_bytes<conflict_request_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  wire::Filling<ConflictRequest> out({in->request_id, 1}, in->request_id);
  out.take(&ConflictRequest::most, most_of(in->most, kMostConflictRegions));
  return out.done();
}

Bytes encode(const ConflictList& value, std::int64_t utime) {
  auto out = answer_part<conflict_list_t>(value, utime, value.regions, &conflict_list_t::regions);
  out.regions_in_all = value.regions_in_all;
  out.voxels_in_all = value.voxels_in_all;
  return wire::to_bytes(out);
}

template <>
Decoded<ConflictList> decode<ConflictList>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kClaim[] = {text(wire::kNameLength), fixed(4 + 4)};
  static constexpr WireField kRegion[] = {fixed(24 + 4), count(kMaxClaims), records(kClaim)};
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kIdLength), fixed(4 + 4 + 8 + 8), count(kMostInPart),
                                          records(kRegion)};
  const auto in = wire::from_bytes<conflict_list_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  if (in->regions_in_all < 0 || in->voxels_in_all < 0) return bad(Code::kMalformed, "a count is negative");
  auto out = read_part(*in, &conflict_list_t::regions, &ConflictList::regions);
  if (!out) return out;
  out->regions_in_all = in->regions_in_all;
  out->voxels_in_all = in->voxels_in_all;
  return out;
}

}  // namespace concord
