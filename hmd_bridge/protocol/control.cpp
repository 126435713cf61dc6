#include "protocol/control.hpp"

#include "core/text.hpp"

namespace concord::hmd {
namespace {

tl::unexpected<BadText> bad(std::string message, std::optional<std::int64_t> id = std::nullopt) {
  return tl::unexpected<BadText>(BadText{id, std::move(message), false});
}

/// The id of an envelope, if it is one: read first, so that every later refusal reaches its asker.
std::optional<std::int64_t> id_of(const Json& json) {
  const auto it = json.find("id");
  if (it == json.end() || !it->is_number_integer() || *it < 1 || *it > kMaxRequestId) return std::nullopt;
  return it->get<std::int64_t>();
}

const std::string* text_at(const Json& json, const char* name) {
  const auto it = json.find(name);
  return it != json.end() && it->is_string() ? it->get_ptr<const std::string*>() : nullptr;
}

std::string in_words(const std::string& message, Problem problem) {
  (void)problem.within(message);
  return problem.text;
}

}  // namespace

bool nests_at_most(std::string_view text, int most) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if ((c == '[' || c == '{') && ++depth > most) return false;
    if (c == ']' || c == '}') --depth;
  }
  return true;
}

tl::expected<ClientText, BadText> read_client_text(std::string_view text) {
  if (text.size() > kMaxTextBytes) return bad("a text frame has at most " + std::to_string(kMaxTextBytes) + " bytes");
  if (!nests_at_most(text, kMaxJsonDepth)) return bad("nests deeper than any message of " + std::string(kProtocol));
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return bad("is not JSON");
  if (!json.is_object()) return bad("must be an object");
  const std::optional<std::int64_t> id = id_of(json);
  const auto body = json.find("body");
  if (body == json.end()) return bad("lacks body", id);

  Problem problem;
  if (const std::string* name = text_at(json, "request")) {
    if (!id) return bad("a request needs an id from 1 to 2^32 - 1");
    if (json.size() != 3) return bad("a request is id, request and body", id);
    ClientRequest request{*id, {}};
    const std::optional<bool> read = read_request(*name, *body, request.body, problem);
    if (!read) return bad("no request is called " + cut_to(*name, 40), id);
    if (!*read) return tl::unexpected<BadText>(BadText{id, in_words(*name, problem), problem.is_name});
    return ClientText(std::move(request));
  }
  const std::string* name = text_at(json, "notice");
  if (name == nullptr || json.size() != 2) return bad("is neither a request nor a notice", id);
  NoticeBody notice;
  const std::optional<bool> read = read_notice(*name, *body, notice, problem);
  if (!read) return bad("no notice is called " + cut_to(*name, 40));
  if (!*read) return bad(in_words(*name, problem));
  return ClientText(std::move(notice));
}

std::string envelope(std::int64_t id, const char* what, Json body) {
  Json json = {{"id", id}};
  json[what] = std::move(body);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string event_envelope(const char* name, Json body) {
  Json json = {{"event", name}};
  json["body"] = std::move(body);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

bool may_retry(Code code) {
  return code == Code::kBusy || code == Code::kRate || code == Code::kTimeout || code == Code::kLocked ||
         code == Code::kUnavailable;
}

}  // namespace concord::hmd
