// One connection: the TLS handshake, HTTP requests, and the step up to a WebSocket.

#include <type_traits>

#include "server/reply.hpp"
#include "server/web_socket.hpp"

namespace concord::hmd {
namespace {

using boost::asio::ip::tcp;
using Plain = beast::tcp_stream;
using Secure = beast::ssl_stream<beast::tcp_stream>;

constexpr std::uint32_t kMaxHeader = 8192, kMaxBody = 4096;

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
    if (!core_->gate.may_ask(address_, core_->now())) {
      if (core_->gate.may_be_noted(address_, core_->now())) core_->hub.note_refused(address_, "page", "RATE");
      return end();
    }
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
    const S status = reply.status();
    const bool who = status == S::unauthorized || status == S::forbidden || status == S::too_many_requests;
    if (who && core_->gate.may_be_noted(address_, core_->now())) {
      const char* what = request.target() == "/api/ticket" ? "ticket"
                         : request.target() == "/ws"       ? "connection"
                                                           : "page";
      core_->hub.note_refused(address_, what, std::to_string(static_cast<unsigned>(status)));
    }
    return reply;
  }

  /// Under way: it stays where it is until the last of it is written.
  template <class Response>
  struct Sending {
    Sending(Response&& which, std::shared_ptr<const std::string> held)
        : response(std::move(which)), body(std::move(held)) {}
    Response response;
    std::shared_ptr<const std::string> body;
    http::response_serializer<typename Response::body_type> serializer{response};
  };

  void write(Reply reply) {
    std::visit(
        [&](auto& response) {
          using Response = std::decay_t<decltype(response)>;
          write_some(std::make_shared<Sending<Response>>(std::move(response), std::move(reply.body)));
        },
        reply.response);
  }

  /// Who takes some of a large body in time has as much time for the next.
  template <class Response>
  void write_some(std::shared_ptr<Sending<Response>> sending) {
    expire();
    auto& serializer = sending->serializer;
    http::async_write_some(stream_, serializer,
                           [self = this->shared_from_this(), sending](beast::error_code e, std::size_t) {
                             if (!e && !sending->serializer.is_done()) return self->write_some(sending);
                             if (!e && sending->response.keep_alive()) return self->read();
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
