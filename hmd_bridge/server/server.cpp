#include "server/server_core.hpp"

#include <algorithm>

#include <boost/asio/ip/address.hpp>

#include "bus/site.hpp"

namespace concord::hmd {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

constexpr std::size_t kLocalConnections = 32;  ///< that nobody from elsewhere takes

void use_certificate(asio::ssl::context& tls, const Server::Config& config) {
  boost::system::error_code error;
  tls.set_options(asio::ssl::context::default_workarounds | asio::ssl::context::no_sslv2 |
                  asio::ssl::context::no_sslv3 | asio::ssl::context::no_tlsv1 | asio::ssl::context::no_tlsv1_1);
  tls.use_certificate_chain_file(config.certificate.string(), error);
  if (error)
    throw ConfigError("cannot use the certificate " + config.certificate.string() + ": " + error.message() +
                      "; concord cert makes one");
  tls.use_private_key_file(config.key.string(), asio::ssl::context::pem, error);
  if (error)
    throw ConfigError("cannot use the key " + config.key.string() + ": " + error.message() +
                      "; concord cert makes one");
}

}  // namespace

Server::Core::Core(asio::io_context& io, Hub& hub_in, Gate& gate_in, TokenStore& tokens_in, const StaticFiles& files_in,
                   Config config_in, std::function<std::int64_t()> now_in)
    : hub(hub_in),
      gate(gate_in),
      tokens(tokens_in),
      files(files_in),
      config(std::move(config_in)),
      now(std::move(now_in)),
      tls(asio::ssl::context::tls_server),
      acceptor(io) {
  if (config.tls) use_certificate(tls, config);
  listen();
  if (config.listener) take_listener(*config.listener);
}

void Server::Core::listen() {
  boost::system::error_code error;
  const auto address = asio::ip::make_address(config.listen == "localhost" ? "127.0.0.1" : config.listen, error);
  if (error) throw ConfigError("bridge.listen " + config.listen + " is no address");
  if (!config.tls && !address.is_loopback()) throw ConfigError("beyond this machine only with TLS");
  const tcp::endpoint endpoint(address, config.port);
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) {
    throw ConfigError("cannot listen on " + config.listen + " port " + std::to_string(config.port) + ": " +
                      error.message());
  }
}

void Server::Core::take_listener(int descriptor) {
  boost::system::error_code error;
  given.emplace(acceptor.get_executor());
  given->assign(tcp::v4(), descriptor, error);
  const tcp::endpoint endpoint = error ? tcp::endpoint() : given->local_endpoint(error);
  if (error) throw ConfigError("descriptor " + std::to_string(descriptor) + " is no listening socket");
  if (!config.tls && !endpoint.address().is_loopback()) throw ConfigError("beyond this machine only with TLS");
}

void Server::Core::accept() {
  accept_from(acceptor);
  if (given) accept_from(*given);
}

void Server::Core::accept_from(tcp::acceptor& from) {
  from.async_accept([self = shared_from_this(), &from](const boost::system::error_code& error, tcp::socket socket) {
    if (!from.is_open()) return;
    if (!error) self->take(std::move(socket));
    self->accept_from(from);
  });
}

void Server::Core::take(tcp::socket socket) {
  boost::system::error_code error;
  const auto remote = socket.remote_endpoint(error);
  if (error) return;
  const std::string address = remote.address().to_string();
  auto place = admit(address);
  if (!place) return;
  socket.set_option(tcp::no_delay(true), error);
  if (config.tls) {
    serve_tls(shared_from_this(), std::move(socket), address, std::move(place));
  } else {
    serve_plain(shared_from_this(), std::move(socket), address, std::move(place));
  }
}

std::vector<std::string> Server::Core::addresses() const {
  const std::string scheme = config.tls ? "https://" : "http://";
  const auto address_of = [&](const tcp::endpoint& endpoint) {
    const std::string host = endpoint.address().to_string();
    return scheme + (endpoint.address().is_v6() ? "[" + host + "]" : host) + ":" + std::to_string(endpoint.port()) +
           "/";
  };
  std::vector<std::string> addresses;
  if (given) addresses.push_back(address_of(given->local_endpoint()));
  addresses.push_back(address_of(acceptor.local_endpoint()));
  return addresses;
}

std::shared_ptr<void> Server::Core::admit(const std::string& address) {
  const std::string network = network_of(address);
  const auto same = by_network_.find(network);
  const std::size_t kept =
      is_loopback(address) ? 0 : std::min<std::size_t>(kLocalConnections, config.max_connections / 4);
  if (connections_ >= config.max_connections - kept) return nullptr;
  if (!is_loopback(address) && same != by_network_.end() && same->second >= config.max_connections_per_address)
    return nullptr;
  ++connections_;
  ++by_network_[network];
  return std::shared_ptr<void>(this, [self = shared_from_this(), network](void*) {
    --self->connections_;
    if (--self->by_network_[network] == 0) self->by_network_.erase(network);
  });
}

void Server::Core::pump() {
  for (const Hub::Connection connection : hub.take_ready()) {
    const auto it = sockets_.find(connection);
    if (it == sockets_.end()) continue;
    if (const auto socket = it->second.lock()) socket->pump();
  }
}

void Server::Core::stop() {
  boost::system::error_code ignored;
  acceptor.close(ignored);
  if (given) given->close(ignored);
  hub.end();
  pump();
}

Server::Server(asio::io_context& io, Hub& hub, Gate& gate, TokenStore& tokens, const StaticFiles& files, Config config,
               std::function<std::int64_t()> now)
    : core_(std::make_shared<Core>(io, hub, gate, tokens, files, std::move(config), std::move(now))) {
  core_->accept();
}

Server::~Server() { core_->over = true; }
std::uint16_t Server::port() const { return core_->acceptor.local_endpoint().port(); }
std::vector<std::string> Server::addresses() const { return core_->addresses(); }
void Server::pump() { core_->pump(); }
void Server::stop() { core_->stop(); }

}  // namespace concord::hmd
