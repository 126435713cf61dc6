#pragma once

// Private to the server's files.

#include <map>
#include <optional>
#include <set>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>

#include "server/server.hpp"

namespace concord::hmd {

/// One WebSocket, whatever it runs on.
class Socket {
 public:
  Socket() = default;
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  virtual ~Socket() = default;
  /// Something may have to be written.
  virtual void pump() = 0;
};

/// What all connections share.
class Server::Core : public std::enable_shared_from_this<Server::Core> {
 public:
  Core(boost::asio::io_context& io, Hub& hub_in, Gate& gate_in, TokenStore& tokens_in, const StaticFiles& files_in,
       Config config_in, std::function<std::int64_t()> now_in);

  void accept();
  [[nodiscard]] std::vector<std::string> addresses() const;
  void stop();
  void pump();
  /// A connection ends when the answer's last copy goes. Null: there are too many.
  [[nodiscard]] std::shared_ptr<void> admit(const std::string& address);
  void open(Hub::Connection connection, const std::shared_ptr<Socket>& socket) { sockets_[connection] = socket; }
  void close(Hub::Connection connection) { sockets_.erase(connection); }

  Hub& hub;
  Gate& gate;
  TokenStore& tokens;
  const StaticFiles& files;
  Config config;
  std::function<std::int64_t()> now;
  boost::asio::ssl::context tls;
  boost::asio::ip::tcp::acceptor acceptor;
  std::optional<boost::asio::ip::tcp::acceptor> given;  ///< the listener that it was started with
  bool over = false;  ///< the server has gone, and the hub may have: connections that are left end by themselves

 private:
  void listen();
  void take_listener(int descriptor);
  void accept_from(boost::asio::ip::tcp::acceptor& from);
  void take(boost::asio::ip::tcp::socket socket);

  std::map<Hub::Connection, std::weak_ptr<Socket>> sockets_;
  std::map<std::string, std::size_t> by_network_;
  std::size_t connections_ = 0;
};

/// Serves one connection, from its first byte.
void serve_tls(std::shared_ptr<Server::Core> core, boost::asio::ip::tcp::socket socket, std::string address,
               std::shared_ptr<void> place);
void serve_plain(std::shared_ptr<Server::Core> core, boost::asio::ip::tcp::socket socket, std::string address,
                 std::shared_ptr<void> place);

}  // namespace concord::hmd
