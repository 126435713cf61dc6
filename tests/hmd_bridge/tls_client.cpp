#include "tls_client.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <sstream>

namespace concord::hmd {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;

std::chrono::milliseconds milliseconds(double s) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(s * 1000));
}

}  // namespace

class TlsClient::Parts {
 public:
  using Stream = websocket::stream<beast::ssl_stream<beast::tcp_stream>>;

  Parts(std::uint16_t port, int window) : tls(asio::ssl::context::tls_client), ws(io, tls) {
    tls.set_verify_mode(asio::ssl::verify_none);
    beast::error_code error;
    tcp::socket& socket = beast::get_lowest_layer(ws).socket();
    socket.open(tcp::v4(), error);
    if (window > 0) socket.set_option(asio::socket_base::receive_buffer_size(window), error);
    socket.connect({asio::ip::make_address("127.0.0.1"), port}, error);
    if (!error) ok = wait([this](auto done) { ws.next_layer().async_handshake(asio::ssl::stream_base::client, done); });
  }

  /// Runs one operation to its end, at most 10 s.
  template <class Start>
  bool wait(Start start, double seconds = 10) {
    bool finished = false;
    beast::error_code result;
    start([&](beast::error_code error, auto&&...) {
      result = error;
      finished = true;
    });
    io.restart();
    const auto until = std::chrono::steady_clock::now() + milliseconds(seconds);
    while (!finished && std::chrono::steady_clock::now() < until) {
      if (io.run_one_until(until) == 0) break;
    }
    if (!finished) {
      beast::get_lowest_layer(ws).close();
      io.restart();
      while (!finished && io.run_one() > 0) {
      }
    }
    return !result;
  }

  asio::io_context io{1};
  asio::ssl::context tls;
  Stream ws;
  bool ok = false, upgraded = false, gone = false, reading = false, arrived = false;
  beast::flat_buffer in;
};

TlsClient::TlsClient(std::uint16_t port, int window) : parts_(std::make_unique<Parts>(port, window)) {}
TlsClient::~TlsClient() {
  beast::get_lowest_layer(parts_->ws).close();
  parts_->io.restart();
  parts_->io.run_for(std::chrono::milliseconds(200));
}

bool TlsClient::send_raw(const std::string& bytes) {
  return parts_->ok &&
         parts_->wait([&](auto done) { asio::async_write(parts_->ws.next_layer(), asio::buffer(bytes), done); });
}

std::string TlsClient::http(const std::string& request) {
  if (!send_raw(request)) return {};
  http::response_parser<http::string_body> parser;
  parser.body_limit(64 << 20);
  beast::flat_buffer buffer;
  if (!parts_->wait([&](auto done) { http::async_read(parts_->ws.next_layer(), buffer, parser, done); }, 30)) return {};
  std::ostringstream out;
  out << parser.get();
  return out.str();
}

std::string TlsClient::http_begin(const std::string& request) {
  if (!send_raw(request)) return {};
  std::string line(12, ' ');
  return parts_->wait([&](auto done) { asio::async_read(parts_->ws.next_layer(), asio::buffer(line), done); }) ? line
                                                                                                               : "";
}

std::size_t TlsClient::read_slowly(std::size_t bytes, double bytes_per_second) {
  std::vector<char> piece(32 << 10);
  const auto start = std::chrono::steady_clock::now();
  asio::steady_timer pace(parts_->io);
  std::size_t got = 0;
  while (got < bytes) {
    const std::size_t before = got;
    const bool more = parts_->wait([&](auto done) {
      parts_->ws.next_layer().async_read_some(asio::buffer(piece), [&got, done](beast::error_code e, std::size_t n) {
        got += n;
        done(e);
      });
    });
    if (!more && got == before) break;
    pace.expires_at(start + milliseconds(static_cast<double>(got) / bytes_per_second));
    parts_->wait([&](auto done) { pace.async_wait(done); });
  }
  return got;
}

int TlsClient::upgrade(const std::string& host, const std::string& origin, const std::string& protocol) {
  if (!parts_->ok) return 0;
  parts_->ws.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
    if (!origin.empty()) request.set(http::field::origin, origin);
    if (!protocol.empty()) request.set(http::field::sec_websocket_protocol, protocol);
  }));
  parts_->ws.read_message_max(64 << 20);
  websocket::response_type response;
  parts_->upgraded = parts_->wait([&](auto done) { parts_->ws.async_handshake(response, host, "/ws", done); });
  return response.result_int();
}

bool TlsClient::send_text(const std::string& text) {
  parts_->ws.binary(false);
  return parts_->wait([&](auto done) { parts_->ws.async_write(asio::buffer(text), done); });
}

bool TlsClient::send_binary(const Bytes& bytes) {
  parts_->ws.binary(true);
  return parts_->wait([&](auto done) { parts_->ws.async_write(asio::buffer(bytes), done); });
}

std::optional<TlsClient::Message> TlsClient::read(double seconds) {
  Parts& p = *parts_;
  if (p.gone || !p.upgraded) return std::nullopt;
  if (!p.reading && !p.arrived) {
    p.reading = true;
    p.ws.async_read(p.in, [&p](beast::error_code error, std::size_t) {
      p.reading = false;
      p.gone = static_cast<bool>(error);
      p.arrived = !error;
    });
  }
  const auto until = std::chrono::steady_clock::now() + milliseconds(seconds);
  p.io.restart();
  while (p.reading && p.io.run_one_until(until) > 0) {
  }
  if (!p.arrived) return std::nullopt;
  p.arrived = false;
  Message message{p.ws.got_text(), beast::buffers_to_string(p.in.cdata())};
  p.in.consume(p.in.size());
  return message;
}

std::optional<std::string> TlsClient::read_text(const std::function<bool(const std::string&)>& wanted, double seconds) {
  const auto until = std::chrono::steady_clock::now() + milliseconds(seconds);
  for (;;) {
    const double left = std::chrono::duration<double>(until - std::chrono::steady_clock::now()).count();
    if (left <= 0) return std::nullopt;
    auto message = read(left);
    if (!message) return std::nullopt;
    if (message->text && wanted(message->data)) return message->data;
  }
}

bool TlsClient::closed() const { return parts_->gone || !parts_->ok; }
int TlsClient::close_code() const { return parts_->ws.reason().code; }

}  // namespace concord::hmd
