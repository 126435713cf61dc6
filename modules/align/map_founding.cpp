#include "align/map_founding.hpp"

#include <bit>
#include <optional>
#include <utility>

#include "align/align_task.hpp"
#include "core/text.hpp"

namespace concord {
namespace {

constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kLongestStem = 70;  // of an id of 80 characters
constexpr std::uint64_t kLongestText = 80;

void append(Bytes& out, const std::string& text) {
  append_varint(out, text.size());
  out.insert(out.end(), text.begin(), text.end());
}

void append(Bytes& out, const TransformRequest& request) {
  for (const std::string* text : {&request.id, &request.author, &request.agent, &request.frame_id}) append(out, *text);
  const Eigen::Matrix4d& T = request.T_map_agent.matrix();
  for (int i = 0; i < 12; ++i) append_le(out, std::bit_cast<std::uint64_t>(T(i % 3, i / 3)));
}

bool read(ByteSpan& in, std::string& out) {
  const auto size = read_varint(in);
  if (!size || *size > kLongestText || *size > in.size()) return false;
  out.assign(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(*size));
  in = in.subspan(*size);
  return true;
}

bool read(ByteSpan& in, TransformRequest& out) {
  for (std::string* text : {&out.id, &out.author, &out.agent, &out.frame_id}) {
    if (!read(in, *text)) return false;
  }
  for (int i = 0; i < 12; ++i) {
    const auto bits = read_le<std::uint64_t>(in);
    if (!bits) return false;
    out.T_map_agent.matrix()(i % 3, i / 3) = std::bit_cast<double>(*bits);
  }
  const Eigen::Matrix3d R = out.T_map_agent.linear();
  const bool is_rigid = R.allFinite() && (R * R.transpose()).isIdentity(1e-6) && R.determinant() > 0.0;
  return is_rigid && make_transform(out.T_map_agent.translation(), Eigen::Quaterniond(R).coeffs()).has_value() &&
         is_request_id(out.id) && is_author(out.author) && is_name(out.agent);
}

std::optional<MapFounding> read_founding(ByteSpan in) {
  MapFounding out;
  const auto version = read_le<std::uint8_t>(in);
  const auto is_undone = read_le<std::uint8_t>(in);
  const auto utime = read_le<std::int64_t>(in);
  if (!version || *version != kVersion || !is_undone || *is_undone > 1 || !utime || *utime < 0) return std::nullopt;
  out.is_undone = *is_undone == 1;
  out.utime = *utime;
  if (!read(in, out.align_id) || !read(in, out.target) || !read(in, out.source) || !in.empty()) return std::nullopt;
  return out;
}

}  // namespace

FoundingStep next_step(const MapFounding& founding, const AgentLayers& layers, bool is_founded, std::int64_t now,
                       std::int64_t open_for) {
  if (founding.is_undone) return FoundingStep::kTakeBack;
  const auto placed = [&](const TransformRequest& request) {
    const auto it = layers.find(request.agent);
    return it != layers.end() && it->second.frame_id == request.frame_id && it->second.T_map_agent;
  };
  if (placed(founding.source)) return FoundingStep::kOver;
  const TransformRequest& target = founding.target;
  if (lies_at({target.agent, target.frame_id, target.T_map_agent}, layers)) return FoundingStep::kPlaceSource;
  // Somebody else moved it, or the other half would lie in a map that others made.
  if (placed(target)) return FoundingStep::kOver;
  if (is_founded && layers.contains(target.agent)) return FoundingStep::kTakeBack;
  // It may have been placed all the same, where merge was not heard.
  if (now - founding.utime > open_for) return FoundingStep::kTakeBack;
  return is_founded ? FoundingStep::kWait : FoundingStep::kPlaceTarget;
}

std::string founding_id(const std::string& decision_id) {
  const bool is_short = decision_id.size() <= kLongestStem;
  return (is_short ? decision_id : decision_id.substr(decision_id.size() - kLongestStem)) + ".target";
}

UndoRequest take_back(const MapFounding& founding, std::int64_t now) {
  const TransformRequest& target = founding.target;
  return {founding.taking_back_id(), target.author, target.id, false, now};
}

Bytes to_bytes(const MapFounding& founding) {
  Bytes out;
  append_le(out, kVersion);
  append_le(out, static_cast<std::uint8_t>(founding.is_undone ? 1 : 0));
  append_le(out, founding.utime);
  append(out, founding.align_id);
  append(out, founding.target);
  append(out, founding.source);
  return out;
}

Result<MapFounding> founding_of(ByteSpan bytes) {
  if (auto founding = read_founding(bytes)) return std::move(*founding);
  return refuse(Code::kMalformed, "what was kept of a map that was about to be founded is no such thing");
}

}  // namespace concord
