// Translators of alignment: core/alignment.hpp.

#include <concord/align_decision_t.hpp>
#include <concord/align_request_t.hpp>
#include <concord/align_result_t.hpp>

#include <algorithm>
#include <cmath>

#include "bus/translate.hpp"
#include "core/text.hpp"

namespace concord {
namespace {

using wire::bad;

constexpr std::int64_t kMaxLayers = 1000;  ///< as the site file allows agents
constexpr std::int64_t kMaxLoose = 6;
constexpr std::int64_t kMaxRivals = 16;
constexpr std::int64_t kReasonLength = 20;
Result<std::string> agent_or_map(const std::string& agent) {
  if (agent.empty()) return agent;
  return wire::agent_of(agent);
}

Result<std::string> frame_id_of(const std::string& frame_id) {
  if (frame_id.empty() || is_name(frame_id)) return frame_id;
  return refuse(Code::kBadFrame, "a frame id must be empty or a name");
}

Result<std::string> align_id_of(const std::string& id) {
  if (is_request_id(id)) return id;
  return refuse(Code::kBadRequest, std::string("align_id must be ") + kIdRule);
}

Result<std::optional<Transform>> guess_of(const align_request_t& in) {
  if (in.has_guess == 0) return std::nullopt;
  const auto T = wire::from_wire(in.T_target_source);
  if (!T) return tl::unexpected(T.error());
  return *T;
}

Result<AlignDecision::Op> op_of(std::int8_t op) {
  switch (op) {
    case align_decision_t::ACCEPT: return AlignDecision::Op::kAccept;
    case align_decision_t::DROP: return AlignDecision::Op::kDrop;
    default: return refuse(Code::kBadRequest, "op must be ACCEPT or DROP");
  }
}

align_layer_t to_wire(const AlignResult::Used& used) {
  align_layer_t out{};
  out.agent = used.agent;
  out.frame_id = used.frame_id;
  out.revision = used.revision;
  return out;
}

Result<AlignResult::Used> used_of(const align_layer_t& in) {
  if (!is_name(in.agent) || !is_name(in.frame_id) || in.revision < 0) {
    return refuse(Code::kBadName, "a layer needs the names of an agent and its frame, and a revision");
  }
  return AlignResult::Used{in.agent, in.frame_id, in.revision};
}

Result<std::vector<AlignResult::Used>> layers_of(const align_result_t& in) {
  std::vector<AlignResult::Used> out;
  for (const align_layer_t& layer : in.layers) {
    auto used = used_of(layer);
    if (!used) return tl::unexpected(used.error());
    out.push_back(std::move(*used));
  }
  return out;
}

Result<void> check_numbers(const align_result_t& in) {
  for (const double share :
       {in.overlap_source, in.overlap_target, in.against_walls, in.against_floors, in.free_space_violation}) {
    if (!(share >= 0.0 && share <= 1.0)) return refuse(Code::kBadRequest, "a share is not from 0 to 1");
  }
  for (const double number : {in.rms, in.ms, in.slip, in.slip_angle}) {
    if (!std::isfinite(number) || number < 0.0) return refuse(Code::kNotFinite, "a length or time is none");
  }
  if (!std::all_of(std::begin(in.covariance), std::end(in.covariance), [](double c) { return std::isfinite(c); })) {
    return refuse(Code::kNotFinite, "the covariance is not finite");
  }
  if (!std::all_of(std::begin(in.centre), std::end(in.centre), [](double c) { return std::isfinite(c); })) {
    return refuse(Code::kNotFinite, "the centre is not finite");
  }
  if (in.iterations < 0 || in.hypotheses < 0) return refuse(Code::kBadRequest, "a count is negative");
  return {};
}

Result<void> check_texts(const align_result_t& in) {
  if (!is_printable(in.reason) || in.reason.empty() || !is_printable(in.message)) {
    return refuse(Code::kBadRequest, "reason and message must be printable");
  }
  if (!std::all_of(in.loose.begin(), in.loose.end(), [](const std::string& text) { return is_printable(text); })) {
    return refuse(Code::kBadRequest, "an open direction is not printable");
  }
  return {};
}

Result<std::vector<Transform>> rivals_of(const align_result_t& in) {
  std::vector<Transform> out;
  for (const transform_t& rival : in.rivals) {
    const auto T = wire::from_wire(rival);
    if (!T) return tl::unexpected(T.error());
    out.push_back(*T);
  }
  return out;
}

Result<Alignment> evidence_of(const align_result_t& in) {
  if (auto fine = check_numbers(in); !fine) return tl::unexpected(fine.error());
  if (auto fine = check_texts(in); !fine) return tl::unexpected(fine.error());
  const auto T = wire::from_wire(in.T_target_source);
  if (!T) return tl::unexpected(T.error());
  const auto reason = align_reason(in.reason);
  if (!reason) return refuse(Code::kBadRequest, "no such reason: " + in.reason);
  Alignment out;
  out.reason = *reason;
  out.message = in.message;
  out.T_target_source = *T;
  out.overlap_source = in.overlap_source;
  out.overlap_target = in.overlap_target;
  out.rms = in.rms;
  std::copy(std::begin(in.covariance), std::end(in.covariance), out.covariance.data());
  out.covariance.transposeInPlace();  // row by row there, by columns here
  out.p_target_centre = Eigen::Vector3d(in.centre[0], in.centre[1], in.centre[2]);
  auto rivals = rivals_of(in);
  if (!rivals) return tl::unexpected(rivals.error());
  out.T_target_source_rivals = std::move(*rivals);
  out.loose = in.loose;
  out.against_upright = in.against_walls;
  out.against_level = in.against_floors;
  out.free_space_violation = in.free_space_violation;
  out.iterations = in.iterations;
  out.hypotheses = in.hypotheses;
  out.ms = in.ms;
  return out;
}

void put_evidence(const Alignment& value, align_result_t& out) {
  out.reason = name(value.reason);
  out.message = value.message;
  out.T_target_source = wire::to_wire(value.T_target_source);
  out.overlap_source = value.overlap_source;
  out.overlap_target = value.overlap_target;
  out.rms = value.rms;
  const Eigen::Matrix<double, 6, 6> by_rows = value.covariance.transpose();
  std::copy_n(by_rows.data(), 36, std::begin(out.covariance));
  Eigen::Map<Eigen::Vector3d>(out.centre) = value.p_target_centre;
  out.rival_count = static_cast<std::int32_t>(value.T_target_source_rivals.size());
  for (const Transform& rival : value.T_target_source_rivals) out.rivals.push_back(wire::to_wire(rival));
  out.loose_count = static_cast<std::int32_t>(value.loose.size());
  out.loose = value.loose;
  out.against_walls = value.against_upright;
  out.against_floors = value.against_level;
  out.free_space_violation = value.free_space_violation;
  out.iterations = value.iterations;
  out.hypotheses = value.hypotheses;
  out.ms = value.ms;
}

}  // namespace

Bytes encode(const AlignRequest& value) {
  auto out = wire::asked_by<align_request_t>(value, value.utime);
  out.source = value.source;
  out.source_frame_id = value.source_frame_id;
  out.target = value.target;
  out.target_frame_id = value.target_frame_id;
  out.has_guess = value.T_target_source.has_value() ? 1 : 0;
  out.T_target_source = wire::to_wire(value.T_target_source.value_or(Transform::Identity()));
  return wire::to_bytes(out);
}

template <>
Decoded<AlignRequest> decode<AlignRequest>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {record(wire::kAsker),    text(wire::kNameLength),
                                          text(wire::kNameLength), text(wire::kNameLength),
                                          text(wire::kNameLength), fixed(1 + wire::kTransformBytes)};
  const auto in = wire::read_asked<align_request_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  auto out = wire::asked_by<AlignRequest>(*in);
  out.take(&AlignRequest::source, wire::agent_of(in->source));
  out.take(&AlignRequest::source_frame_id, frame_id_of(in->source_frame_id));
  out.take(&AlignRequest::target, agent_or_map(in->target));
  out.take(&AlignRequest::target_frame_id, frame_id_of(in->target_frame_id));
  out.take(&AlignRequest::T_target_source, guess_of(*in));
  return out.done();
}

Bytes encode(const AlignDecision& value) {
  auto out = wire::asked_by<align_decision_t>(value, value.utime);
  out.op = value.op == AlignDecision::Op::kAccept ? align_decision_t::ACCEPT : align_decision_t::DROP;
  out.align_id = value.align_id;
  return wire::to_bytes(out);
}

template <>
Decoded<AlignDecision> decode<AlignDecision>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayout[] = {record(wire::kAsker), fixed(1), text(wire::kIdLength)};
  const auto in = wire::read_asked<align_decision_t>(bytes, kLayout);
  if (!in) return tl::unexpected(in.error());
  auto out = wire::asked_by<AlignDecision>(*in);
  out.take(&AlignDecision::op, op_of(in->op));
  out.take(&AlignDecision::align_id, align_id_of(in->align_id));
  return out.done();
}

Bytes encode(const AlignResult& value) {
  align_result_t out{};
  out.utime = value.utime;
  out.align_id = value.id;
  out.author = value.author;
  out.source = to_wire(value.source);
  out.target = value.target;
  out.count = static_cast<std::int32_t>(value.layers.size());
  for (const AlignResult::Used& used : value.layers) out.layers.push_back(to_wire(used));
  out.open = value.open ? 1 : 0;
  put_evidence(value.evidence, out);
  out.slip = value.slip;
  out.slip_angle = value.slip_angle;
  return wire::to_bytes(out);
}

template <>
Decoded<AlignResult> decode<AlignResult>(std::span<const std::uint8_t> bytes) {
  static constexpr WireField kLayer[] = {text(wire::kNameLength), text(wire::kNameLength), fixed(8)};
  static constexpr WireField kLayout[] = {fixed(8),
                                          text(wire::kIdLength),
                                          text(wire::kIdLength),
                                          record(kLayer),
                                          text(wire::kNameLength),
                                          count(kMaxLayers),
                                          records(kLayer),
                                          fixed(1),
                                          text(kReasonLength),
                                          text(wire::kMessageLength),
                                          fixed(wire::kTransformBytes + 3 * 8 + 36 * 8 + 3 * 8),
                                          count(kMaxRivals),
                                          array(wire::kTransformBytes),
                                          count(kMaxLoose),
                                          texts(wire::kIdLength),
                                          fixed(3 * 8 + 2 * 4 + 3 * 8)};
  const auto in = wire::from_bytes<align_result_t>(bytes, kLayout);
  if (!in) return bad(in.error());
  if (!is_request_id(in->align_id)) return wire::bad_id();
  AlignResult value;
  value.id = in->align_id;
  value.open = in->open != 0;
  value.slip = in->slip;
  value.slip_angle = in->slip_angle;
  wire::Filling<AlignResult> out(std::move(value), {});
  out.take(&AlignResult::author, wire::author_of(in->author));
  out.take(&AlignResult::utime, wire::time_of(in->utime));
  out.take(&AlignResult::source, used_of(in->source));
  out.take(&AlignResult::target, agent_or_map(in->target));
  out.take(&AlignResult::layers, layers_of(*in));
  out.take(&AlignResult::evidence, evidence_of(*in));
  return out.done();
}

}  // namespace concord
