// Translators of detections: core/detections.hpp.

#include "bus/messages_detection.hpp"

#include <concord/detection_decision_t.hpp>
#include <concord/detection_t.hpp>
#include <concord/things_t.hpp>

#include "bus/translate_list.hpp"
#include "bus/translate_shape.hpp"
#include "core/assets.hpp"

namespace concord {
namespace {

using wire::bad;

std::int8_t to_wire(DetectionDecision::Op op) {
  return op == DetectionDecision::Op::kConfirm ? detection_decision_t::CONFIRM : detection_decision_t::DROP;
}

Result<DetectionDecision::Op> op_of(std::int8_t op) {
  switch (op) {
    case detection_decision_t::CONFIRM: return DetectionDecision::Op::kConfirm;
    case detection_decision_t::DROP: return DetectionDecision::Op::kDrop;
    default: return refuse(Code::kBadRequest, "op must be CONFIRM or DROP");
  }
}

Result<std::int64_t> number_of(std::int64_t thing) {
  if (thing >= 1) return thing;
  return refuse(Code::kBadRequest, "things count from 1");
}

Result<double> score_of(double score) {
  if (score >= 0.0 && score <= 1.0) return score;
  return refuse(Code::kBadRequest, "a score lies between 0 and 1");
}

Result<std::string> empty_or_id(const std::string& id, const char* what) {
  if (id.empty() || is_request_id(id)) return id;
  return refuse(Code::kBadRequest, std::string(what) + " must be empty, or " + kIdRule);
}

Decoded<Thing> from_wire(const thing_t& in) {
  wire::Filling<Thing> out({}, {});
  out.take(&Thing::number, number_of(in.number));
  out.take(&Thing::asset, is_name(in.asset)
                              ? Result<std::string>(in.asset)
                              : refuse(Code::kBadName, std::string("an asset's name must be ") + kNameRule));
  out.take(&Thing::class_name, wire::title_of(in.class_name));
  out.take(&Thing::score, score_of(in.score));
  out.take(&Thing::sightings, wire::not_negative(in.sightings, "sightings").map([](std::int64_t n) {
    return static_cast<std::int32_t>(n);
  }));
  out.take(&Thing::last_seen, wire::time_of(in.last_seen));
  out.take(&Thing::author, wire::author_of(in.author));
  out.take(&Thing::T_map_asset, wire::from_wire(in.T_map_asset));
  out.take(&Thing::injection, empty_or_id(in.injection, "injection"));
  return out.done();
}

thing_t to_wire(const Thing& thing) {
  thing_t out{};
  out.number = thing.number;
  out.asset = thing.asset;
  out.class_name = thing.class_name;
  out.score = thing.score;
  out.sightings = thing.sightings;
  out.last_seen = thing.last_seen;
  out.author = thing.author;
  out.T_map_asset = wire::to_wire(thing.T_map_asset);
  out.injection = thing.injection;
  return out;
}

}  // namespace

Bytes encode(const Detection& value) {
  auto out = wire::asked_by<detection_t>(value, value.utime);
  out.asset = value.asset;
  out.object = value.object;
  out.score = value.score;
  out.T_frame_asset = wire::to_wire(value.T_frame_asset);
  wire::put_frame(value.frame, out);
  return wire::to_bytes(out);
}

template <>
Decoded<Detection> decode<Detection>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {record(wire::kAsker),         text(wire::kTitleLength),
                                          text(wire::kIdLength),        fixed(8),
                                          fixed(wire::kTransformBytes), record(wire::kFrame)};
  const auto in = wire::read_asked<detection_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  auto out = wire::asked_by<Detection>(*in);
  out.take(&Detection::asset, wire::title_of(in->asset));
  out.take(&Detection::object, empty_or_id(in->object, "object"));
  out.take(&Detection::score, score_of(in->score));
  out.take(&Detection::T_frame_asset, wire::from_wire(in->T_frame_asset));
  out.take(&Detection::frame, wire::frame_of(*in));
  return out.done();
}

Bytes encode(const DetectionDecision& value) {
  auto out = wire::asked_by<detection_decision_t>(value, value.utime);
  out.op = to_wire(value.op);
  out.thing = value.thing;
  return wire::to_bytes(out);
}

template <>
Decoded<DetectionDecision> decode<DetectionDecision>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {record(wire::kAsker), fixed(1), fixed(8)};
  const auto in = wire::read_asked<detection_decision_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  auto out = wire::asked_by<DetectionDecision>(*in);
  if (in->request_id.size() > kMostAssetId) {
    out.require(refuse(Code::kBadRequest, "request id must be at most " + std::to_string(kMostAssetId) + " bytes"));
  }
  out.take(&DetectionDecision::op, op_of(in->op));
  out.take(&DetectionDecision::thing, number_of(in->thing));
  return out.done();
}

Bytes encode(const ListPart<Thing>& value, std::int64_t utime) {
  return wire::write_list(value, utime, &things_t::things, to_wire);
}

template <>
Decoded<ListPart<Thing>> decode<ListPart<Thing>>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kThing[] = {fixed(8),
                                         text(wire::kNameLength),
                                         text(wire::kTitleLength),
                                         fixed(8 + 4 + 8),
                                         text(wire::kIdLength),
                                         fixed(wire::kTransformBytes),
                                         text(wire::kIdLength)};
  return wire::read_list<Thing>(bytes, &things_t::things, kThing, static_cast<std::int64_t>(kMaxThings), from_wire);
}

}  // namespace concord
