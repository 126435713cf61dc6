#include <thread>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>

#include "tls_client.hpp"

namespace concord::hmd {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using Frames = std::vector<std::shared_ptr<const Bytes>>;

/// As bare as Beast's own examples.
class BareSession : public std::enable_shared_from_this<BareSession> {
 public:
  BareSession(tcp::socket socket, asio::ssl::context& tls, const Frames& frames)
      : ws_(std::move(socket), tls), frames_(frames) {}

  void start() {
    ws_.next_layer().async_handshake(asio::ssl::stream_base::server,
                                     [self = shared_from_this()](beast::error_code error) {
                                       if (error) return;
                                       self->ws_.auto_fragment(false);
                                       self->ws_.async_accept([self](beast::error_code failed) {
                                         if (!failed) self->read();
                                       });
                                     });
  }

 private:
  void read() {
    in_.consume(in_.size());
    ws_.async_read(in_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return;
      if (beast::buffers_to_string(self->in_.cdata()) == "again") {
        self->next_ = 0;
        return self->write();
      }
      self->ws_.text(true);
      self->ws_.async_write(self->in_.cdata(), [self](beast::error_code failed, std::size_t) {
        if (!failed) self->read();
      });
    });
  }
  void write() {
    if (next_ == frames_.size()) return read();
    ws_.binary(true);
    ws_.async_write(asio::buffer(*frames_[next_++]), [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (!error) self->write();
    });
  }

  websocket::stream<beast::ssl_stream<beast::tcp_stream>> ws_;
  const Frames& frames_;
  std::size_t next_ = 0;
  beast::flat_buffer in_;
};

}  // namespace

class BareServer::Parts {
 public:
  Parts(const std::string& certificate, const std::string& key, Frames sent)
      : frames(std::move(sent)),
        tls(asio::ssl::context::tls_server),
        acceptor(io, {asio::ip::make_address("127.0.0.1"), 0}) {
    tls.use_certificate_chain_file(certificate);
    tls.use_private_key_file(key, asio::ssl::context::pem);
    accept();
    thread = std::thread([this] { io.run(); });
  }
  ~Parts() {
    io.stop();
    thread.join();
  }
  void accept() {
    acceptor.async_accept([this](beast::error_code error, tcp::socket socket) {
      if (error) return;
      socket.set_option(tcp::no_delay(true));
      std::make_shared<BareSession>(std::move(socket), tls, frames)->start();
      accept();
    });
  }

  Frames frames;
  asio::io_context io{1};
  asio::ssl::context tls;
  tcp::acceptor acceptor;
  std::thread thread;
};

BareServer::BareServer(const std::string& certificate, const std::string& key, Frames frames)
    : parts_(std::make_unique<Parts>(certificate, key, std::move(frames))) {}
BareServer::~BareServer() = default;
std::uint16_t BareServer::port() const { return parts_->acceptor.local_endpoint().port(); }

}  // namespace concord::hmd
