#include "server/reply.hpp"

#include <nlohmann/json.hpp>

namespace concord::hmd {

std::string field(const Request& request, http::field name) {
  const auto value = request[name];
  return {value.data(), value.size()};
}

namespace {

template <class Body>
http::response<Body> begin(const Request& request, http::status status, const char* type) {
  http::response<Body> response(status, request.version());
  response.set(http::field::content_type, type);
  response.set(http::field::cache_control, "no-cache");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("X-Frame-Options", "DENY");
  response.set(
      "Content-Security-Policy",
      "default-src 'self'; img-src 'self' data: blob:; worker-src 'self' blob:; style-src 'self' 'unsafe-inline'; "
      "connect-src 'self' ws: wss:; frame-ancestors 'none'");
  response.keep_alive(request.keep_alive());
  return response;
}

Reply respond(const Request& request, http::status status, const char* type, std::shared_ptr<const std::string> body) {
  auto response = begin<http::span_body<const char>>(request, status, type);
  response.body() = {body->data(), body->size()};
  response.prepare_payload();
  return {std::move(response), std::move(body)};
}

Reply respond_json(const Request& request, http::status status, const nlohmann::json& body) {
  return respond(request, status, "application/json", std::make_shared<const std::string>(body.dump()));
}

Reply error(const Request& request, http::status status, const char* what) {
  return respond_json(request, status, {{"error", what}});
}

Reply ticket(Server::Core& core, const Request& request, const Peer& peer) {
  if (!core.gate.may_try(peer.address, core.now()))
    return error(request, http::status::too_many_requests, "too many tries; wait a moment");
  constexpr std::string_view kBearer = "Bearer ";
  const std::string authorization = field(request, http::field::authorization);
  if (!authorization.starts_with(kBearer))
    return error(request, http::status::unauthorized, "Authorization: Bearer TOKEN is needed");
  const auto identity = core.tokens.find(authorization.substr(kBearer.size()));
  if (!identity && identity.error().code == concord::Code::kBusy)
    return error(request, http::status::service_unavailable, "the tokens are being written; try again");
  if (!identity) {
    core.hub.note_refused(peer.address, "ticket", "IO: " + identity.error().message);
    return error(request, http::status::internal_server_error, "the server cannot read its tokens; its log says why");
  }
  if (!*identity) return error(request, http::status::unauthorized, "no such token");
  const auto issued = core.gate.issue(**identity, core.now());
  if (!issued) return error(request, http::status::service_unavailable, "too many tickets wait; try again in 10 s");
  return respond_json(request, http::status::ok, {{"ticket", *issued}, {"seconds", Gate::kTicketLife / 1'000'000}});
}

Reply file_reply(Server::Core& core, const Request& request, const Peer& peer, const StaticFiles::File& file) {
  const char* type = file.type.c_str();
  if (request.method() == http::verb::head)
    return respond(request, http::status::ok, type, std::make_shared<const std::string>());
  const auto may_have = [&](std::uint64_t bytes) { return core.gate.may_take(peer.address, bytes, core.now()); };
  const auto too_much = [&] {
    return error(request, http::status::too_many_requests, "more bytes than allowed; wait a moment");
  };
  if (file.body != nullptr)
    return may_have(file.body->size()) ? respond(request, http::status::ok, type, file.body) : too_much();
  auto response = begin<http::file_body>(request, http::status::ok, type);
  beast::error_code failed;
  response.body().open(file.path.c_str(), beast::file_mode::scan, failed);
  if (failed || response.body().size() > StaticFiles::kMaxModelBytes)
    return error(request, http::status::not_found, "there is nothing by this name");
  if (!may_have(response.body().size())) return too_much();
  response.prepare_payload();
  return {std::move(response)};
}

/// Whether a header with a list of names has this one.
bool lists(const std::string& header, std::string_view name) {
  for (const auto& token : http::token_list(header)) {
    if (std::string_view(token.data(), token.size()) == name) return true;
  }
  return false;
}

}  // namespace

Reply answer(Server::Core& core, const Request& request, const Peer& peer) {
  const std::string target(request.target().data(), request.target().size());
  const std::string scheme = core.config.tls ? "https" : "http";
  if (!origin_allowed(field(request, http::field::origin), scheme, field(request, http::field::host),
                      core.config.origins)) {
    return error(request, http::status::forbidden, "pages from there may not ask here");
  }
  if (target == "/api/ticket") {
    if (request.method() != http::verb::post) return error(request, http::status::method_not_allowed, "POST it");
    return ticket(core, request, peer);
  }
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    return error(request, http::status::method_not_allowed, "GET or HEAD");
  }
  if (target == "/api/info")
    return respond_json(request, http::status::ok, {{"protocol", kProtocol}, {"ticket_needed", !peer.local}});
  const auto file = core.files.find(target);
  if (file == nullptr) return error(request, http::status::not_found, "there is nothing by this name");
  return file_reply(core, request, peer, *file);
}

std::optional<Reply> refusal(Server::Core& core, const Request& request, const Peer& peer) {
  if (request.target() != "/ws") return error(request, http::status::not_found, "the WebSocket is at /ws");
  if (!lists(field(request, http::field::sec_websocket_protocol), kProtocol)) {
    return error(request, http::status::bad_request, "Sec-WebSocket-Protocol must offer hmd.v1");
  }
  const std::string scheme = core.config.tls ? "https" : "http";
  if (!origin_allowed(field(request, http::field::origin), scheme, field(request, http::field::host),
                      core.config.origins)) {
    return error(request, http::status::forbidden, "pages from there may not connect here; see bridge.origins");
  }
  if (!peer.local && !core.gate.may_try(peer.address, core.now())) {
    return error(request, http::status::too_many_requests, "too many tries; wait a moment");
  }
  return std::nullopt;
}

}  // namespace concord::hmd
