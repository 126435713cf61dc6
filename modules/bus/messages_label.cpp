// Translators of labels: core/label_corrections.hpp.

#include "bus/messages_label.hpp"

#include <array>

#include <concord/label_list_t.hpp>
#include <concord/label_query_t.hpp>
#include <concord/label_request_t.hpp>
#include <concord/label_slots_t.hpp>

#include "bus/translate_list.hpp"
#include "bus/translate_shape.hpp"

namespace concord {
namespace {

using wire::bad;
using Op = LabelRequest::Op;
using Kind = LabelQuery::Kind;

constexpr std::int64_t kMaxListParts = 8192;  ///< of kMaxLabelSlots, 64 a part at most, with the longest names
constexpr std::int64_t kMaxAnswerParts = kMaxLabelSlots;
constexpr double kMostRadius = 100.0;

constexpr std::array<std::pair<std::int8_t, Op>, 9> kOps{{{label_request_t::LABEL, Op::kLabel},
                                                          {label_request_t::RESTORE, Op::kRestore},
                                                          {label_request_t::RENAME, Op::kRename},
                                                          {label_request_t::REASSIGN, Op::kReassign},
                                                          {label_request_t::TAKE_OFF, Op::kTakeOff},
                                                          {label_request_t::DELETE, Op::kDelete},
                                                          {label_request_t::UNDO, Op::kUndo},
                                                          {label_request_t::REDO, Op::kRedo},
                                                          {label_request_t::TOUCH, Op::kTouch}}};
constexpr std::array<std::pair<std::int8_t, Kind>, 6> kKinds{{{label_query_t::ALL, Kind::kAll},
                                                              {label_query_t::AT, Kind::kAt},
                                                              {label_query_t::CLASS, Kind::kClass},
                                                              {label_query_t::WITHIN, Kind::kWithin},
                                                              {label_query_t::BORDER, Kind::kBorder},
                                                              {label_query_t::CLASSES, Kind::kClasses}}};

template <class Table>
auto from_table(const Table& table, std::int8_t number, const char* what) -> Result<decltype(table[0].second)> {
  for (const auto& [wire, value] : table) {
    if (wire == number) return value;
  }
  return refuse(Code::kBadRequest, what);
}
template <class Table, class Value>
std::int8_t to_table(const Table& table, Value value) {
  for (const auto& [wire, known] : table) {
    if (known == value) return wire;
  }
  return 0;
}

Result<std::uint32_t> number_of(std::int32_t number) {
  if (number >= 0) return static_cast<std::uint32_t>(number);
  return refuse(Code::kBadRequest, "numbers of classes and instances count from 1");
}

Result<InstanceId> instance_of(std::int32_t label, std::int32_t instance) {
  return number_of(label).and_then([&](std::uint32_t of) {
    return number_of(instance).map([&](std::uint32_t number) { return InstanceId{of, number}; });
  });
}

Result<std::string> empty_or_title(const std::string& name) {
  if (name.empty()) return name;
  return wire::title_of(name);
}

label_instance_t to_wire(const LabelInstance& instance) {
  label_instance_t out{};
  out.label = static_cast<std::int32_t>(instance.of.label);
  out.instance = static_cast<std::int32_t>(instance.of.instance);
  out.name = instance.name;
  out.voxels = instance.voxels;
  const std::int32_t low[] = {instance.min.x, instance.min.y, instance.min.z};
  const std::int32_t high[] = {instance.max.x, instance.max.y, instance.max.z};
  for (int i = 0; i < 3; ++i) {
    out.min[i] = low[i];
    out.max[i] = high[i];
    out.centroid[i] = instance.centroid[i];
  }
  out.asset = instance.asset;
  out.T_map_asset = wire::to_wire(instance.T_map_asset);
  return out;
}

Decoded<LabelInstance> from_wire(const label_instance_t& in) {
  wire::Filling<LabelInstance> out({}, {});
  out.take(&LabelInstance::of, instance_of(in.label, in.instance));
  out.take(&LabelInstance::name, wire::title_of(in.name));
  out.take(&LabelInstance::voxels, wire::not_negative(in.voxels, "voxels"));
  const VoxelIndex min{in.min[0], in.min[1], in.min[2]}, max{in.max[0], in.max[1], in.max[2]};
  const Eigen::Vector3d centroid(in.centroid[0], in.centroid[1], in.centroid[2]);
  const bool fine = in_bounds(min) && in_bounds(max) && min.x <= max.x && min.y <= max.y && min.z <= max.z;
  out.require(fine && centroid.allFinite() ? Result<void>() : refuse(Code::kMalformed, "an instance lies nowhere"));
  out.take(&LabelInstance::min, Result<VoxelIndex>(min));
  out.take(&LabelInstance::max, Result<VoxelIndex>(max));
  out.take(&LabelInstance::centroid, Result<Eigen::Vector3d>(centroid));
  const bool is_asset = in.asset.empty() || is_name(in.asset);
  out.require(is_asset ? Result<void>() : refuse(Code::kBadName, "an instance is an asset that has no name"));
  out.take(&LabelInstance::asset, Result<std::string>(in.asset));
  out.take(&LabelInstance::T_map_asset, wire::from_wire(in.T_map_asset));
  return out.done();
}

label_slot_t to_wire(const LabelSlot& slot) {
  label_slot_t out{};
  out.slot = slot.slot;
  out.label = static_cast<std::int32_t>(slot.of.label);
  out.instance = static_cast<std::int32_t>(slot.of.instance);
  out.name = slot.name;
  return out;
}

Decoded<LabelSlot> from_wire(const label_slot_t& in) {
  wire::Filling<LabelSlot> out({}, {});
  out.require(in.slot >= 0 && in.slot < kMaxLabelSlots ? Result<void>() : refuse(Code::kMalformed, "no such slot"));
  out.take(&LabelSlot::slot, Result<std::int32_t>(in.slot));
  out.take(&LabelSlot::of, instance_of(in.label, in.instance));
  out.take(&LabelSlot::name, wire::title_of(in.name));
  return out.done();
}

}  // namespace

Bytes encode(const LabelRequest& value) {
  auto out = wire::asked_by<label_request_t>(value, value.utime);
  out.op = to_table(kOps, value.op);
  out.name = value.name;
  out.label = static_cast<std::int32_t>(value.of.label);
  out.instance = static_cast<std::int32_t>(value.of.instance);
  out.to_instance = static_cast<std::int32_t>(value.to_instance);
  out.correction_id = value.correction_id;
  out.shape = wire::to_wire(value.shape);
  wire::put_frame(value.frame, out);
  return wire::to_bytes(out);
}

template <>
Decoded<LabelRequest> decode<LabelRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {
      record(wire::kAsker),  fixed(1),     text(wire::kTitleLength), fixed(4 * 3),
      text(wire::kIdLength), wire::kShape, text(wire::kNameLength),  text(wire::kNameLength)};
  const auto in = wire::read_asked<label_request_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  auto out = wire::asked_by<LabelRequest>(*in);
  out.take(&LabelRequest::op, from_table(kOps, in->op, "op is none of label_request_t's"));
  out.take(&LabelRequest::name, empty_or_title(in->name));
  out.take(&LabelRequest::of, instance_of(in->label, in->instance));
  out.take(&LabelRequest::to_instance, number_of(in->to_instance));
  const bool undo = in->op == label_request_t::UNDO || in->op == label_request_t::REDO;
  const bool fits_op = undo ? is_request_id(in->correction_id) : in->correction_id.empty();
  if (!fits_op) out.require(refuse(Code::kBadRequest, "correction_id is for UNDO and REDO alone"));
  out.take(&LabelRequest::correction_id, Result<std::string>(in->correction_id));
  if (in->op == label_request_t::LABEL || in->op == label_request_t::RESTORE || in->op == label_request_t::TOUCH) {
    out.take(&LabelRequest::shape, wire::shape_from_wire(in->shape));
  }
  out.take(&LabelRequest::frame, wire::frame_of(*in));
  return out.done();
}

Bytes encode(const LabelQuery& value, std::int64_t utime) {
  label_query_t out{};
  out.utime = utime;
  out.request_id = value.id;
  out.kind = to_table(kKinds, value.kind);
  out.name = value.name;
  for (int i = 0; i < 3; ++i) out.p_map[i] = value.p_map[i];
  out.radius = value.radius;
  return wire::to_bytes(out);
}

template <>
Decoded<LabelQuery> decode<LabelQuery>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kIdLength), fixed(1), text(wire::kTitleLength),
                                          fixed(8 * 4)};
  const auto in = wire::request_from_bytes<label_query_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  wire::Filling<LabelQuery> out({}, in->request_id);
  out.take(&LabelQuery::id, Result<std::string>(in->request_id));
  out.take(&LabelQuery::kind, from_table(kKinds, in->kind, "kind is none of label_query_t's"));
  out.take(&LabelQuery::name, empty_or_title(in->name));
  const Eigen::Vector3d p(in->p_map[0], in->p_map[1], in->p_map[2]);
  out.require(p.allFinite() ? Result<void>() : refuse(Code::kNotFinite, "the point is not finite"));
  out.require(p.allFinite() && p.cwiseAbs().maxCoeff() > kFarthest
                  ? refuse(Code::kOutOfBounds, "the point lies beyond any map")
                  : Result<void>());
  out.take(&LabelQuery::p_map, Result<Eigen::Vector3d>(p));
  out.require(in->radius >= 0.0 && in->radius <= kMostRadius
                  ? Result<void>()
                  : refuse(Code::kBadRequest, "radius must lie between 0 and 100 m"));
  out.take(&LabelQuery::radius, Result<double>(in->radius));
  return out.done();
}

std::vector<LabelList> in_parts(LabelList whole) {
  const auto all = std::exchange(whole.instances, {});
  std::vector<LabelList> parts{whole};
  std::size_t size = 0;
  for (const LabelInstance& item : all) {
    const auto more = static_cast<std::size_t>(to_wire(item).getEncodedSize());
    if (!parts.back().instances.empty() && (size + more > kPartBytes || parts.back().instances.size() >= kMostInPart)) {
      parts.push_back(whole);
      size = 0;
    }
    parts.back().instances.push_back(item);
    size += more;
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].part = static_cast<std::int32_t>(i);
    parts[i].parts = static_cast<std::int32_t>(parts.size());
  }
  return parts;
}

Bytes encode(const LabelList& value, std::int64_t utime) {
  label_list_t out;
  out.utime = utime;
  out.request_id = value.id;
  out.part = value.part;
  out.parts = value.parts;
  out.count = static_cast<std::int32_t>(value.instances.size());
  for (const LabelInstance& instance : value.instances) out.instances.push_back(to_wire(instance));
  return wire::to_bytes(out);
}

template <>
Decoded<LabelList> decode<LabelList>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kInstance[] = {fixed(4 + 4), text(wire::kTitleLength), fixed(8 + 24 + 24),
                                            text(wire::kNameLength), fixed(wire::kTransformBytes)};
  static constexpr WireField kLayout[] = {fixed(8), text(wire::kIdLength), fixed(4 + 4), count(kMostInPart),
                                          records(kInstance)};
  const auto in = wire::from_bytes<label_list_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  if (!is_printable(in->request_id)) return wire::bad_id();
  if (auto fine = wire::check_part(in->part, in->parts, kMaxAnswerParts); !fine) return bad(fine.error());
  LabelList out{in->request_id, in->part, in->parts, {}};
  for (const auto& one : in->instances) {
    auto value = from_wire(one);
    if (!value) return tl::unexpected(value.error());
    out.instances.push_back(std::move(*value));
  }
  return out;
}

Bytes encode(const ListPart<LabelSlot>& value, std::int64_t utime) {
  return wire::write_list(value, utime, &label_slots_t::slots, to_wire);
}

template <>
Decoded<ListPart<LabelSlot>> decode<ListPart<LabelSlot>>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kSlot[] = {fixed(4 * 3), text(wire::kTitleLength)};
  return wire::read_list<LabelSlot>(bytes, &label_slots_t::slots, kSlot, kMaxListParts, from_wire);
}

}  // namespace concord
