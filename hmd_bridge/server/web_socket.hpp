#pragma once

// Private to the server's files: Beast, in a header that connection.cpp alone includes.

#include <deque>
#include <optional>

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>

#include "core/text.hpp"
#include "server/reply.hpp"

namespace concord::hmd {

namespace websocket = beast::websocket;

inline std::chrono::steady_clock::duration seconds(double s) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(s));
}

/// One client: reads into the hub, writes what the hub has, one message under way at a time.
template <class Stream>
class WebSocket final : public Socket, public std::enable_shared_from_this<WebSocket<Stream>> {
 public:
  WebSocket(std::shared_ptr<Server::Core> core, Stream stream, std::shared_ptr<void> place)
      : core_(std::move(core)), place_(std::move(place)), ws_(std::move(stream)), cut_(ws_.get_executor()) {}
  ~WebSocket() override { leave(); }

  void start(const http::request<http::string_body>& request, const Peer& peer) {
    websocket::stream_base::timeout timeouts{};
    timeouts.handshake_timeout = seconds(core_->config.header_seconds);
    timeouts.idle_timeout = seconds(core_->config.idle_seconds);
    timeouts.keep_alive_pings = true;
    ws_.set_option(timeouts);
    ws_.set_option(websocket::stream_base::decorator(
        [](websocket::response_type& response) { response.set(http::field::sec_websocket_protocol, kProtocol); }));
    ws_.read_message_max(kMaxBinaryBytes);
    ws_.auto_fragment(false);
    ws_.async_accept(request, [self = this->shared_from_this(), peer](beast::error_code error) {
      if (error) return;
      const auto opened = self->core_->hub.open(peer, self->core_->now());
      if (!opened) {
        self->core_->hub.note_refused(peer.address, "connection", "BUSY");
        return self->shut(1013, opened.error().message);
      }
      self->connection_ = *opened;
      self->core_->open(*opened, self);
      self->read();
    });
  }

  void pump() override {
    if (!connection_ || writing_ || closing_) {
      if (connection_ && writing_ && core_->hub.closing(*connection_)) cut_later();
      return;
    }
    if (auto next = core_->hub.next(*connection_)) return write(std::move(*next));
    if (const auto closing = core_->hub.closing(*connection_)) shut(closing->code, closing->reason);
  }

 private:
  void read() {
    ws_.async_read(in_, [self = this->shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->leave();
      self->take();
      self->core_->pump();
      if (self->connection_) self->read();
    });
  }

  void take() {
    const auto bytes = in_.cdata();
    const auto* data = static_cast<const std::uint8_t*>(bytes.data());
    if (ws_.got_text()) {
      core_->hub.text(*connection_, {reinterpret_cast<const char*>(data), bytes.size()}, core_->now());
    } else {
      core_->hub.binary(*connection_, {data, bytes.size()}, core_->now());
    }
    in_.consume(in_.size());
    if (in_.capacity() > kMaxTextBytes) in_.shrink_to_fit();
  }

  void write(Hub::Outgoing next) {
    writing_ = std::move(next);
    const auto* text = std::get_if<SharedText>(&*writing_);
    ws_.binary(text == nullptr);
    const auto buffer =
        text != nullptr ? boost::asio::buffer(**text) : boost::asio::buffer(*std::get<FramePointer>(*writing_));
    ws_.async_write(buffer, [self = this->shared_from_this()](beast::error_code error, std::size_t) {
      self->writing_.reset();
      if (error) return self->leave();
      self->pump();
    });
  }

  void shut(std::uint16_t code, const std::string& reason) {
    closing_ = true;
    cut_later();
    ws_.async_close(websocket::close_reason(static_cast<websocket::close_code>(code), cut_to(reason, 120)),
                    [self = this->shared_from_this()](beast::error_code) { self->leave(); });
  }

  /// Who does not take the bye, or does not close, is cut off.
  void cut_later() {
    if (cutting_) return;
    cutting_ = true;
    cut_.expires_after(seconds(core_->config.close_seconds));
    cut_.async_wait([self = this->shared_from_this()](beast::error_code error) {
      if (!error) beast::get_lowest_layer(self->ws_).close();
    });
  }

  void leave() {
    if (!connection_) return;
    if (!core_->over) {
      core_->hub.closed(*connection_, core_->now());
      core_->close(*connection_);
    }
    connection_.reset();
    boost::system::error_code ignored;
    cut_.cancel(ignored);
  }

  std::shared_ptr<Server::Core> core_;
  std::shared_ptr<void> place_;
  websocket::stream<Stream> ws_;
  beast::flat_buffer in_;
  std::optional<Hub::Connection> connection_;
  std::optional<Hub::Outgoing> writing_;
  bool closing_ = false, cutting_ = false;
  boost::asio::steady_timer cut_;
};

}  // namespace concord::hmd
