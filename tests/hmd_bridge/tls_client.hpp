#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/byte_stream.hpp"

namespace concord::hmd {

/// A client of the bridge over a real socket with TLS, for tests and benches: any bytes, at any time. It trusts any
/// certificate.
class TlsClient {
 public:
  /// @param window bytes that the system takes in for it before it reads; 0: as usual
  explicit TlsClient(std::uint16_t port, int window = 0);
  ~TlsClient();
  TlsClient(const TlsClient&) = delete;
  TlsClient& operator=(const TlsClient&) = delete;

  /// Sends bytes as they are, after the TLS handshake.
  bool send_raw(const std::string& bytes);
  /// A whole HTTP answer to `request`, with its header; empty if the server closed.
  std::string http(const std::string& request);
  /// The first line of the answer to `request`; what comes after it stays unread.
  std::string http_begin(const std::string& request);
  /// Reads at most `bytes` of what comes, at most so many a second. @return how many came before the other side ended.
  std::size_t read_slowly(std::size_t bytes, double bytes_per_second);
  /// The step up to a WebSocket. @return the HTTP status: 101 if it was made.
  int upgrade(const std::string& host, const std::string& origin = "", const std::string& protocol = "hmd.v1");

  bool send_text(const std::string& text);
  bool send_binary(const Bytes& bytes);
  struct Message {
    bool text = true;
    std::string data;
  };
  /// The next message; nothing once the other side has closed, or after `seconds`.
  std::optional<Message> read(double seconds = 10);
  /// Reads until a text for which `wanted` holds.
  std::optional<std::string> read_text(const std::function<bool(const std::string&)>& wanted, double seconds = 10);
  [[nodiscard]] bool closed() const;
  /// Of the close frame; 0: none came.
  [[nodiscard]] int close_code() const;

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

/// The bare thing to compare with: a WebSocket server over TLS that does nothing but send the given frames to whoever
/// sends "again", and what it gets to whoever sends anything else. In a thread of its own.
class BareServer {
 public:
  BareServer(const std::string& certificate, const std::string& key, std::vector<std::shared_ptr<const Bytes>> frames);
  ~BareServer();
  BareServer(const BareServer&) = delete;
  BareServer& operator=(const BareServer&) = delete;
  [[nodiscard]] std::uint16_t port() const;

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace concord::hmd
