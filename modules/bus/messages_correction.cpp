// Translators of what people do to the map: core/corrections.hpp.

#include <concord/edit_t.hpp>
#include <concord/lease_request_t.hpp>
#include <concord/localise_request_t.hpp>
#include <concord/set_transform_t.hpp>
#include <concord/undo_t.hpp>
#include <concord/weight_request_t.hpp>
#include <concord/zone_request_t.hpp>

#include "bus/translate_shape.hpp"
#include "core/text.hpp"

namespace concord {
namespace {

using wire::bad;

Result<std::int64_t> base_of(std::int64_t base_revision) {
  if (base_revision >= kAnyRevision) return base_revision;
  return refuse(Code::kBadRequest, "base_revision must be a revision, or -1");
}

Result<std::vector<std::string>> known_of(const std::vector<std::string>& ids) {
  if (std::ranges::all_of(ids, is_request_id)) return ids;
  return refuse(Code::kBadRequest, "known must hold ids of edits");
}

std::int8_t to_wire(EditRequest::Op op) {
  switch (op) {
    case EditRequest::Op::kAdd: return edit_t::ADD;
    case EditRequest::Op::kDelete: return edit_t::DELETE;
    case EditRequest::Op::kMove: return edit_t::MOVE;
  }
  return 0;
}

Result<EditRequest::Op> edit_op(std::int8_t op) {
  switch (op) {
    case edit_t::ADD: return EditRequest::Op::kAdd;
    case edit_t::DELETE: return EditRequest::Op::kDelete;
    case edit_t::MOVE: return EditRequest::Op::kMove;
    default: return refuse(Code::kBadRequest, "op must be ADD, DELETE or MOVE");
  }
}

std::int8_t to_wire(ZoneRequest::Op op) {
  switch (op) {
    case ZoneRequest::Op::kAdd: return zone_request_t::ADD;
    case ZoneRequest::Op::kChange: return zone_request_t::CHANGE;
    case ZoneRequest::Op::kDelete: return zone_request_t::DELETE;
  }
  return 0;
}

Result<ZoneRequest::Op> zone_op(std::int8_t op) {
  switch (op) {
    case zone_request_t::ADD: return ZoneRequest::Op::kAdd;
    case zone_request_t::CHANGE: return ZoneRequest::Op::kChange;
    case zone_request_t::DELETE: return ZoneRequest::Op::kDelete;
    default: return refuse(Code::kBadRequest, "op must be ADD, CHANGE or DELETE");
  }
}

Result<bool> redo_of(std::int8_t op) {
  if (op != undo_t::UNDO && op != undo_t::REDO) return refuse(Code::kBadRequest, "op must be UNDO or REDO");
  return op == undo_t::REDO;
}

Result<bool> hold_of(std::int8_t op) {
  if (op != lease_request_t::HOLD && op != lease_request_t::FREE) {
    return refuse(Code::kBadRequest, "op must be HOLD or FREE");
  }
  return op == lease_request_t::HOLD;
}

Result<std::string> lease_of(const std::string& lease) {
  if (is_request_id(lease)) return lease;
  return refuse(Code::kBadName, std::string("a lease's id must be ") + kIdRule);
}

Result<std::string> edit_id_of(const undo_t& in) {
  // Not the rule for new ids: whatever an edit was called, it can be taken back.
  if (is_kept_id(in.edit_id)) return in.edit_id;
  return refuse(Code::kBadRequest, std::string("edit_id must be ") + kKeptIdRule);
}

Result<std::string> frame_id_of(const std::string& frame_id) {
  if (frame_id.empty() || is_name(frame_id)) return frame_id;
  return refuse(Code::kBadFrame, "frame_id must be empty or a name");
}

Result<int> weight_of(std::int32_t weight) {
  if (weight >= 1 && weight <= 1000) return weight;
  return refuse(Code::kBadRequest, "weight must lie between 1 and 1000");
}

Result<Eigen::Vector3d> move_of(const edit_t& in) {
  const Eigen::Vector3d move(in.move[0], in.move[1], in.move[2]);
  if (!move.allFinite()) return refuse(Code::kNotFinite, "move is not finite");
  if (move.cwiseAbs().maxCoeff() > kFarthest) {
    return refuse(Code::kOutOfBounds, "move leads beyond the map; is it in metres?");
  }
  return move;
}

}  // namespace

Bytes encode(const EditRequest& value) {
  auto out = wire::asked_by<edit_t>(value, value.utime);
  out.op = to_wire(value.op);
  out.shape = wire::to_wire(value.shape);
  for (int i = 0; i < 3; ++i) out.move[i] = value.move[i];
  wire::put_frame(value.frame, out);
  out.base_revision = value.base_revision;
  out.known = value.known;
  out.known_count = static_cast<std::int32_t>(value.known.size());
  return wire::to_bytes(out);
}

template <>
Decoded<EditRequest> decode<EditRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {
      record(wire::kAsker), fixed(1), wire::kShape,          fixed(24),
      record(wire::kFrame), fixed(8), count(kMaxKnownEdits), texts(wire::kIdLength)};
  const auto in = wire::read_asked<edit_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  auto out = wire::asked_by<EditRequest>(*in);
  out.take(&EditRequest::op, edit_op(in->op));
  out.take(&EditRequest::shape, wire::shape_from_wire(in->shape));
  if (in->op == edit_t::MOVE) out.take(&EditRequest::move, move_of(*in));
  out.take(&EditRequest::frame, wire::frame_of(*in));
  out.take(&EditRequest::base_revision, base_of(in->base_revision));
  out.take(&EditRequest::known, known_of(in->known));
  return out.done();
}

Bytes encode(const UndoRequest& value) {
  auto out = wire::asked_by<undo_t>(value, value.utime);
  out.op = value.redo ? undo_t::REDO : undo_t::UNDO;
  out.edit_id = value.edit_id;
  return wire::to_bytes(out);
}

template <>
Decoded<UndoRequest> decode<UndoRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {record(wire::kAsker), fixed(1), text(wire::kIdLength)};
  const auto in = wire::read_asked<undo_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  auto out = wire::asked_by<UndoRequest>(*in);
  out.take(&UndoRequest::redo, redo_of(in->op));
  out.take(&UndoRequest::edit_id, edit_id_of(*in));
  return out.done();
}

Bytes encode(const ZoneRequest& value) {
  auto out = wire::asked_by<zone_request_t>(value, value.utime);
  out.op = to_wire(value.op);
  out.name = value.name;
  out.kind = wire::to_wire(value.kind);
  out.volume = wire::to_wire(value.volume);
  out.margin = value.margin;
  out.cost = value.cost;
  wire::put_frame(value.frame, out);
  out.base_revision = value.base_revision;
  return wire::to_bytes(out);
}

template <>
Decoded<ZoneRequest> decode<ZoneRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {record(wire::kAsker), fixed(1),     text(wire::kTitleLength), fixed(1),
                                          wire::kShape,         fixed(8 + 4), record(wire::kFrame),     fixed(8)};
  const auto in = wire::read_asked<zone_request_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  auto out = wire::asked_by<ZoneRequest>(*in);
  out.take(&ZoneRequest::op, zone_op(in->op));
  // Whatever a zone was called, it can be changed and deleted: the rule for names is for new ones.
  const bool is_new = in->op == zone_request_t::ADD;
  out.take(&ZoneRequest::name, is_new ? wire::title_of(in->name) : wire::kept_title_of(in->name));
  if (in->op != zone_request_t::DELETE) {
    out.take(&ZoneRequest::kind, wire::zone_kind(in->kind));
    out.take(&ZoneRequest::volume, wire::volume_from_wire(in->volume));
    out.take(&ZoneRequest::margin, wire::margin_of(*in));
    out.take(&ZoneRequest::cost, Result<int>(in->cost));
  }
  out.take(&ZoneRequest::frame, wire::frame_of(*in));
  out.take(&ZoneRequest::base_revision, base_of(in->base_revision));
  return out.done();
}

Bytes encode(const LeaseRequest& value) {
  auto out = wire::asked_by<lease_request_t>(value, value.utime);
  out.lease_id = value.lease;
  out.op = value.hold ? lease_request_t::HOLD : lease_request_t::FREE;
  out.volume = wire::to_wire(value.volume);
  wire::put_frame(value.frame, out);
  return wire::to_bytes(out);
}

template <>
Decoded<LeaseRequest> decode<LeaseRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {record(wire::kAsker), text(wire::kIdLength), fixed(1), wire::kShape,
                                          record(wire::kFrame)};
  const auto in = wire::read_asked<lease_request_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  auto out = wire::asked_by<LeaseRequest>(*in);
  out.take(&LeaseRequest::lease, lease_of(in->lease_id));
  out.take(&LeaseRequest::hold, hold_of(in->op));
  if (in->op != lease_request_t::FREE) out.take(&LeaseRequest::volume, wire::volume_from_wire(in->volume));
  out.take(&LeaseRequest::frame, wire::frame_of(*in));
  return out.done();
}

Bytes encode(const WeightRequest& value) {
  auto out = wire::asked_by<weight_request_t>(value, value.utime);
  out.agent = value.agent;
  out.weight = value.weight;
  return wire::to_bytes(out);
}

template <>
Decoded<WeightRequest> decode<WeightRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {record(wire::kAsker), text(wire::kNameLength), fixed(4)};
  const auto in = wire::read_asked<weight_request_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  auto out = wire::asked_by<WeightRequest>(*in);
  out.take(&WeightRequest::agent, wire::agent_of(in->agent));
  out.take(&WeightRequest::weight, weight_of(in->weight));
  return out.done();
}

Bytes encode(const LocaliseRequest& value) {
  auto out = wire::asked_by<localise_request_t>(value, value.utime);
  out.agent = value.agent;
  out.T_frame_base = wire::to_wire(value.T_frame_base);
  wire::put_frame(value.frame, out);
  return wire::to_bytes(out);
}

template <>
Decoded<LocaliseRequest> decode<LocaliseRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {record(wire::kAsker), text(wire::kNameLength), fixed(wire::kTransformBytes),
                                          record(wire::kFrame)};
  const auto in = wire::read_asked<localise_request_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  auto out = wire::asked_by<LocaliseRequest>(*in);
  out.take(&LocaliseRequest::agent, wire::agent_of(in->agent));
  out.take(&LocaliseRequest::T_frame_base, wire::from_wire(in->T_frame_base));
  out.take(&LocaliseRequest::frame, wire::frame_of(*in));
  return out.done();
}

Bytes encode(const TransformRequest& value, std::int64_t utime) {
  auto out = wire::asked_by<set_transform_t>(value, utime);
  out.agent = value.agent;
  out.frame_id = value.frame_id;
  out.T_map_agent = wire::to_wire(value.T_map_agent);
  return wire::to_bytes(out);
}

template <>
Decoded<TransformRequest> decode<TransformRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {record(wire::kAsker), text(wire::kNameLength), text(wire::kNameLength),
                                          fixed(wire::kTransformBytes)};
  const auto in = wire::read_asked<set_transform_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  auto out = wire::asked_by<TransformRequest>(*in);
  out.take(&TransformRequest::agent, wire::agent_of(in->agent));
  out.take(&TransformRequest::frame_id, frame_id_of(in->frame_id));
  out.take(&TransformRequest::T_map_agent, wire::from_wire(in->T_map_agent));
  return out.done();
}

}  // namespace concord
