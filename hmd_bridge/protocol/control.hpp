#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <tl/expected.hpp>

#include "protocol/messages.hpp"

namespace concord::hmd {

inline constexpr std::size_t kMaxTextBytes = 1 << 20;  ///< of one text frame from a client
inline constexpr int kMaxJsonDepth = 12;               ///< nothing in the schema is deeper
inline constexpr std::int64_t kMaxRequestId = (std::int64_t{1} << 32) - 1;

struct ClientRequest {
  std::int64_t id = 0;
  RequestBody body;
};
/// What a client says in one text frame.
using ClientText = std::variant<ClientRequest, NoticeBody>;

/// A text that is not of the protocol; with the id that was asked under, where that much could be read.
struct BadText {
  std::optional<std::int64_t> id;
  std::string message;
  bool is_name = false;  ///< the first that is wrong in it is a name
};

/// Reads strictly: one JSON object, an envelope of the schema, a body that its validator accepts.
[[nodiscard]] tl::expected<ClientText, BadText> read_client_text(std::string_view text);

/// Whether brackets nest at most `most` deep, whatever else the text is: asked before a parser recurses into it.
[[nodiscard]] bool nests_at_most(std::string_view text, int most);

[[nodiscard]] std::string envelope(std::int64_t id, const char* what, Json body);
[[nodiscard]] std::string event_envelope(const char* name, Json body);

template <class Answer>
[[nodiscard]] std::string answer_text(std::int64_t id, const Answer& answer) {
  return envelope(id, "answer", write_value(answer));
}
[[nodiscard]] inline std::string error_text(std::int64_t id, const Refusal& refusal) {
  return envelope(id, "error", write_value(refusal));
}
template <class Event>
[[nodiscard]] std::string event_text(const Event& event) {
  return event_envelope(Event::kName, write_value(event));
}

/// What a client writes: for clients in C++, and for tests.
template <class Request>
[[nodiscard]] std::string request_text(std::int64_t id, const Request& request) {
  return Json{{"id", id}, {"request", Request::kName}, {"body", write_value(request)}}.dump();
}
template <class Notice>
[[nodiscard]] std::string notice_text(const Notice& notice) {
  return Json{{"notice", Notice::kName}, {"body", write_value(notice)}}.dump();
}

/// What the schema says of the request that a body is.
[[nodiscard]] inline const RequestInfo& info_of(const RequestBody& body) { return request_infos()[body.index()]; }

/// Codes that the same request may get past in some seconds.
[[nodiscard]] bool may_retry(Code code);

}  // namespace concord::hmd
