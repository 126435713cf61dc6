// One connection: the TLS handshake, HTTP requests, and the step up to a WebSocket.

#include <algorithm>

#include <nlohmann/json.hpp>

#include "server/web_socket.hpp"

namespace concord::hmd {
namespace {

using boost::asio::ip::tcp;
using Plain = beast::tcp_stream;
using Secure = beast::ssl_stream<beast::tcp_stream>;
using Request = http::request<http::string_body>;
using Response = http::response<http::span_body<const char>>;

/// The body is not copied: what holds it goes with the answer.
struct Reply {
  Response response;
  std::shared_ptr<const std::string> body;
};

constexpr std::uint32_t kMaxHeader = 8192, kMaxBody = 4096;

Reply respond(const Request& request, http::status status, const char* type, std::shared_ptr<const std::string> body) {
  Response response(status, request.version());
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

std::string field(const Request& request, http::field name) {
  const auto value = request[name];
  return {value.data(), value.size()};
}

Reply ticket(Server::Core& core, const Request& request, const Peer& peer) {
  if (!core.gate.may_try(peer.address, core.now()))
    return error(request, http::status::too_many_requests, "too many tries; wait a moment");
  constexpr std::string_view kBearer = "Bearer ";
  const std::string authorization = field(request, http::field::authorization);
  if (!authorization.starts_with(kBearer))
    return error(request, http::status::unauthorized, "Authorization: Bearer TOKEN is needed");
  const auto identity = core.tokens.find(authorization.substr(kBearer.size()));
  if (!identity) return error(request, http::status::service_unavailable, "the tokens are being written; try again");
  if (!*identity) return error(request, http::status::unauthorized, "no such token");
  const auto issued = core.gate.issue(**identity, core.now());
  if (!issued) return error(request, http::status::service_unavailable, "too many tickets wait; try again in 10 s");
  return respond_json(request, http::status::ok, {{"ticket", *issued}, {"seconds", Gate::kTicketLife / 1'000'000}});
}

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
  return respond(request, http::status::ok, file->type.c_str(),
                 request.method() == http::verb::head ? std::make_shared<const std::string>() : file->body);
}

/// Whether a header with a list of names has this one.
bool lists(const std::string& header, std::string_view name) {
  for (const auto& token : http::token_list(header)) {
    if (std::string_view(token.data(), token.size()) == name) return true;
  }
  return false;
}

/// Why a WebSocket is refused; nothing: it is not.
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

template <class Stream>
class Connection : public std::enable_shared_from_this<Connection<Stream>> {
 public:
  Connection(std::shared_ptr<Server::Core> core, Stream stream, std::string address, std::shared_ptr<void> place)
      : core_(std::move(core)), stream_(std::move(stream)), address_(std::move(address)), place_(std::move(place)) {}

  void start() {
    expire();
    if constexpr (std::is_same_v<Stream, Secure>) {
      stream_.async_handshake(boost::asio::ssl::stream_base::server,
                              [self = this->shared_from_this()](beast::error_code e) {
                                if (!e) self->read();
                              });
    } else {
      read();
    }
  }

 private:
  void expire() { beast::get_lowest_layer(stream_).expires_after(seconds(core_->config.header_seconds)); }

  void read() {
    parser_.emplace();
    parser_->header_limit(kMaxHeader);
    parser_->body_limit(kMaxBody);
    expire();
    http::async_read(stream_, buffer_, *parser_, [self = this->shared_from_this()](beast::error_code e, std::size_t) {
      if (!e) self->handle();
    });
  }

  void handle() {
    Request request = parser_->release();
    Peer peer{address_, false};
    // A page of another server is not local, even if the site file lets it in: it asks for a ticket.
    const std::string host = field(request, http::field::host);
    peer.local = is_loopback(address_) && is_local_host(host) &&
                 origin_allowed(field(request, http::field::origin), core_->config.tls ? "https" : "http", host, {});
    if (!websocket::is_upgrade(request)) return write(noted(answer(*core_, request, peer), request));
    if (auto refused = refusal(*core_, request, peer)) return write(noted(std::move(*refused), request));
    if (buffer_.size() > 0) return;  // frames before the handshake: no client of ours
    beast::get_lowest_layer(stream_).expires_never();
    std::make_shared<WebSocket<Stream>>(core_, std::move(stream_), std::move(place_))->start(request, peer);
  }

  /// Who is refused for what they are is a line of the audit; what is not there is nobody's business.
  Reply noted(Reply reply, const Request& request) {
    using S = http::status;
    const S status = reply.response.result();
    if (status == S::unauthorized || status == S::forbidden || status == S::too_many_requests) {
      const char* what = request.target() == "/api/ticket" ? "ticket"
                         : request.target() == "/ws"       ? "connection"
                                                           : "page";
      core_->hub.note_refused(address_, what, std::to_string(reply.response.result_int()));
    }
    return reply;
  }

  void write(Reply reply) {
    reply_ = std::move(reply);
    serializer_.emplace(reply_.response);
    write_some();
  }

  /// Who takes some of a large body in time has as much time for the next.
  void write_some() {
    expire();
    http::async_write_some(stream_, *serializer_, [self = this->shared_from_this()](beast::error_code e, std::size_t) {
      if (!e && !self->serializer_->is_done()) return self->write_some();
      if (!e && self->reply_.response.keep_alive()) return self->read();
      self->end();
    });
  }

  void end() {
    expire();
    if constexpr (std::is_same_v<Stream, Secure>) {
      stream_.async_shutdown([self = this->shared_from_this()](beast::error_code) {});
    } else {
      beast::error_code ignored;
      stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    }
  }

  std::shared_ptr<Server::Core> core_;
  Stream stream_;
  std::string address_;
  std::shared_ptr<void> place_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  Reply reply_;
  std::optional<http::response_serializer<http::span_body<const char>>> serializer_;
};

}  // namespace

void serve_tls(std::shared_ptr<Server::Core> core, tcp::socket socket, std::string address,
               std::shared_ptr<void> place) {
  Secure stream(beast::tcp_stream(std::move(socket)), core->tls);
  std::make_shared<Connection<Secure>>(std::move(core), std::move(stream), std::move(address), std::move(place))
      ->start();
}

void serve_plain(std::shared_ptr<Server::Core> core, tcp::socket socket, std::string address,
                 std::shared_ptr<void> place) {
  Plain stream(std::move(socket));
  std::make_shared<Connection<Plain>>(std::move(core), std::move(stream), std::move(address), std::move(place))
      ->start();
}

}  // namespace concord::hmd
