#pragma once

// Private to the translators (messages_*.cpp): what they share.

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include <concord/transform_t.hpp>

#include "bus/messages.hpp"
#include "bus/wire_layout.hpp"
#include "core/text.hpp"
#include "core/transform.hpp"

namespace concord::wire {

inline constexpr std::int64_t kIdLength = kMaxIdBytes;      ///< of request ids and authors
inline constexpr std::int64_t kNameLength = kMaxNameBytes;  ///< see is_name
inline constexpr std::int64_t kMessageLength = 400;         ///< texts for people
inline constexpr std::int64_t kTransformBytes = 56;

template <class Lcm>
[[nodiscard]] Bytes to_bytes(const Lcm& message) {
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// Whether the type's fingerprint stands before it.
template <class Lcm>
[[nodiscard]] bool is_a(std::span<const std::uint8_t> bytes) {
  std::uint64_t fingerprint = 0;
  for (std::size_t i = 0; i < 8 && i < bytes.size(); ++i) fingerprint = fingerprint << 8 | bytes[i];
  return bytes.size() >= 8 && static_cast<std::int64_t>(fingerprint) == Lcm::getHash();
}

/// Decodes after the layout has been checked, so that the generated code only sees lengths that hold.
template <class Lcm>
[[nodiscard]] Result<Lcm> from_bytes(std::span<const std::uint8_t> bytes, std::span<const WireField> layout) {
  if (!is_a<Lcm>(bytes)) {
    return refuse(Code::kMalformed, std::string("not a ") + Lcm::getTypeName() + "; is the sender of this release?");
  }
  const WireCheck check = check_layout(bytes, layout);
  switch (check.fit) {
    case WireFit::kFits: break;
    case WireFit::kTooLarge: return refuse(Code::kTooLarge, std::string(Lcm::getTypeName()) + " has " + check.excess);
    case WireFit::kMalformed:
      return refuse(Code::kMalformed, std::string("bytes that are no ") + Lcm::getTypeName() +
                                          ": cut off, too many, or a text that is not UTF-8");
  }
  Lcm message;
  if (message.decode(bytes.data(), 0, static_cast<int>(bytes.size())) != static_cast<int>(bytes.size())) {
    return refuse(Code::kMalformed, std::string("cannot decode a ") + Lcm::getTypeName());
  }
  return message;
}

[[nodiscard]] inline tl::unexpected<BadMessage> bad(Error error, std::string id = {}) {
  return tl::unexpected<BadMessage>(BadMessage{std::move(error), std::move(id)});
}
[[nodiscard]] inline tl::unexpected<BadMessage> bad(Code code, std::string message, std::string id = {}) {
  return bad(Error{code, std::move(message)}, std::move(id));
}

/// Of a stamp: far from where sums of times would overflow.
inline constexpr std::int64_t kLatestTime = std::int64_t{1} << 62;

[[nodiscard]] inline Result<std::int64_t> time_of(std::int64_t utime) {
  if (utime >= 0 && utime <= kLatestTime) return utime;
  return refuse(Code::kBadRequest, "utime is no time; it must be microseconds since 1970");
}

[[nodiscard]] inline tl::unexpected<BadMessage> bad_id() {
  return bad(Code::kBadRequest, std::string("request id must be ") + kIdRule);
}
[[nodiscard]] inline Result<std::string> author_of(const std::string& author) {
  if (is_author(author)) return author;
  return refuse(Code::kBadRequest, std::string("author must be ") + kAuthorRule);
}
[[nodiscard]] inline Result<std::string> agent_of(const std::string& agent) {
  if (is_name(agent)) return agent;
  return refuse(Code::kBadName, std::string("agent must be ") + kNameRule);
}

/// The id in the place where every request has it, behind its time; empty: it cannot be read, or is none.
[[nodiscard]] inline std::string request_id_in(std::span<const std::uint8_t> bytes) {
  static constexpr std::int64_t kTimeBytes = 8;
  const std::string id = text_at(bytes, kTimeBytes, kIdLength).value_or("");
  return is_request_id(id) ? id : std::string();
}

/// A request whose asker is known. What is wrong with it is said to them wherever their id can be read, be the message
/// cut off or over a limit.
template <class Lcm>
[[nodiscard]] Decoded<Lcm> request_from_bytes(std::span<const std::uint8_t> bytes, std::span<const WireField> layout) {
  auto in = from_bytes<Lcm>(bytes, layout);
  if (!in) return bad(in.error(), is_a<Lcm>(bytes) ? request_id_in(bytes) : std::string());
  if (request_id_in(bytes).empty()) return bad_id();
  return std::move(*in);
}

/// A value that is filled field by field; the first refusal stays, and reaches the asker `id`.
template <class Value>
class Filling {
 public:
  Filling(Value value, std::string id) : value_(std::move(value)), id_(std::move(id)) {}

  template <class Field>
  void take(Field Value::*field, Result<Field> read) {
    if (read) {
      value_.*field = std::move(*read);
    } else {
      require(tl::unexpected(std::move(read.error())));
    }
  }
  void require(Result<void> fine) {
    if (!fine && !error_) error_ = std::move(fine.error());
  }
  [[nodiscard]] const Value& value() const { return value_; }
  [[nodiscard]] Decoded<Value> done() {
    if (error_) return bad(std::move(*error_), std::move(id_));
    return std::move(value_);
  }

 private:
  Value value_;
  std::string id_;
  std::optional<Error> error_;
};

/// What stands first in whatever a person asks for: utime, id, author.
inline constexpr WireField kAsker[] = {fixed(8), text(kIdLength), text(kIdLength)};

/// The id that the asker gave: of the request, unless it is that of what it makes.
template <class Lcm>
[[nodiscard]] auto& id_of(Lcm& message) {
  if constexpr (requires { message.request_id; }) {
    return message.request_id;
  } else {
    return message.edit_id;
  }
}

/// A message with what every asker says.
template <class Lcm, class Value>
[[nodiscard]] Lcm asked_by(const Value& value, std::int64_t utime) {
  Lcm out{};
  out.utime = utime;
  id_of(out) = value.id;
  out.author = value.author;
  return out;
}

template <class Value, class Lcm>
[[nodiscard]] Filling<Value> asked_by(const Lcm& in) {
  Value out;
  out.id = id_of(in);
  out.author = in.author;
  if constexpr (requires { out.utime; }) out.utime = in.utime;
  return {std::move(out), id_of(in)};
}

/// The message, once it is clear who asks.
template <class Lcm>
[[nodiscard]] Decoded<Lcm> read_asked(std::span<const std::uint8_t> bytes, std::span<const WireField> layout) {
  auto in = request_from_bytes<Lcm>(bytes, layout);
  if (!in) return in;
  if (const auto author = author_of(in->author); !author) return bad(author.error(), id_of(*in));
  if (const auto utime = time_of(in->utime); !utime) return bad(utime.error(), id_of(*in));
  return in;
}

/// The frame that something lies in: frame_agent, frame_id.
inline constexpr WireField kFrame[] = {text(kNameLength), text(kNameLength)};

template <class Lcm>
void put_frame(const WorkFrame& frame, Lcm& out) {
  out.frame_agent = frame.agent;
  out.frame_id = frame.frame_id;
}

template <class Lcm>
[[nodiscard]] Result<WorkFrame> frame_of(const Lcm& in) {
  if (!in.frame_agent.empty() && !is_name(in.frame_agent)) {
    return refuse(Code::kBadName, "frame_agent must be empty (the map's frame) or an agent's id");
  }
  if (!in.frame_id.empty() && (in.frame_agent.empty() || !is_name(in.frame_id))) {
    return refuse(Code::kBadFrame, "frame_id must be empty, or a name that comes with frame_agent");
  }
  return WorkFrame{in.frame_agent, in.frame_id};
}

/// A text for people, cut to what its message takes.
[[nodiscard]] inline std::string clipped(std::string text) {
  if (text.size() <= static_cast<std::size_t>(kMessageLength)) return text;
  std::size_t size = kMessageLength;
  while (size > 0 && (text[size] & 0xC0) == 0x80) --size;  // not within a character of UTF-8
  text.resize(size);
  return text;
}

template <class Points>
[[nodiscard]] bool all_finite(const Points& points) {
  return std::all_of(points.begin(), points.end(), [](const auto& p) { return p.allFinite(); });
}

[[nodiscard]] inline transform_t to_wire(const Transform& T) {
  transform_t out;
  const Eigen::Quaterniond q(T.linear());
  for (int i = 0; i < 3; ++i) out.position[i] = T.translation()[i];
  out.quaternion[0] = q.x();
  out.quaternion[1] = q.y();
  out.quaternion[2] = q.z();
  out.quaternion[3] = q.w();
  return out;
}

[[nodiscard]] inline Result<Transform> from_wire(const transform_t& in) {
  return make_transform({in.position[0], in.position[1], in.position[2]},
                        {in.quaternion[0], in.quaternion[1], in.quaternion[2], in.quaternion[3]});
}

[[nodiscard]] inline Result<std::int64_t> not_negative(std::int64_t number, const char* what) {
  if (number >= 0) return number;
  return refuse(Code::kBadRequest, std::string(what) + " must not be negative");
}

[[nodiscard]] inline Result<void> check_part(std::int32_t part, std::int32_t parts, std::int64_t most) {
  if (part < 0 || parts < 1 || part >= parts) return refuse(Code::kMalformed, "part is not one of parts");
  if (parts > most) return refuse(Code::kTooLarge, "has over " + std::to_string(most) + " parts");
  return {};
}

/// Points travel as three arrays: LCM's C++ types would make a vector of each point.
template <class Lcm, class Point>
void put_points(const std::vector<Point>& points, Lcm& out) {
  out.count = static_cast<std::int32_t>(points.size());
  for (const Point& p : points) {
    out.x.push_back(p.x());
    out.y.push_back(p.y());
    out.z.push_back(p.z());
  }
}
template <class Point, class Lcm>
[[nodiscard]] std::vector<Point> points_of(const Lcm& in) {
  std::vector<Point> points;
  points.reserve(in.x.size());
  for (std::size_t i = 0; i < in.x.size(); ++i) points.emplace_back(in.x[i], in.y[i], in.z[i]);
  return points;
}

}  // namespace concord::wire
