#include "client/bridge_client.hpp"

#include <charconv>
#include <chrono>
#include <deque>
#include <map>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

namespace concord::hmd {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using asio::ip::tcp;

constexpr std::chrono::seconds kPatience(5);

/// Of `http://ADDRESS:PORT/`.
std::optional<tcp::endpoint> endpoint_of(const std::string& address) {
  constexpr std::string_view kScheme = "http://";
  const std::size_t colon = address.rfind(':');
  if (!address.starts_with(kScheme) || colon == std::string::npos || colon < kScheme.size()) return std::nullopt;
  boost::system::error_code error;
  const auto host = asio::ip::make_address(address.substr(kScheme.size(), colon - kScheme.size()), error);
  std::uint16_t port = 0;
  const char* end = address.data() + address.size();
  const auto [rest, bad] = std::from_chars(address.data() + colon + 1, end, port);
  if (error || bad != std::errc() || std::string_view(rest, static_cast<std::size_t>(end - rest)) != "/") {
    return std::nullopt;
  }
  return tcp::endpoint(host, port);
}

}  // namespace

/// One connection: a read is always under way, and one write at a time.
class BridgeClient::Link {
 public:
  boost::system::error_code open(const tcp::endpoint& endpoint) {
    boost::system::error_code result = asio::error::timed_out;
    beast::get_lowest_layer(ws_).expires_after(kPatience);
    ws_.set_option(websocket::stream_base::decorator(
        [](websocket::request_type& request) { request.set(beast::http::field::sec_websocket_protocol, kProtocol); }));
    beast::get_lowest_layer(ws_).async_connect(endpoint, [&](boost::system::error_code connected) {
      result = connected;
      if (connected) return;
      ws_.async_handshake("localhost", "/ws", [&](boost::system::error_code shaken) { result = shaken; });
    });
    io_.run();
    io_.restart();
    if (result) return result;
    beast::get_lowest_layer(ws_).expires_never();
    read();
    return {};
  }

  void send(std::string text) {
    out_.push_back(std::move(text));
    if (out_.size() == 1) write();
  }
  void poll() {
    io_.poll();
    io_.restart();
  }
  void wait_until(const std::function<bool()>& done) {
    const auto until = std::chrono::steady_clock::now() + kPatience;
    while (!done() && !lost_ && std::chrono::steady_clock::now() < until) io_.run_one_until(until);
    io_.restart();
  }

  std::map<std::int64_t, Json> answers;
  [[nodiscard]] bool lost() const { return lost_; }

 private:
  void read() {
    ws_.async_read(in_, [this](boost::system::error_code error, std::size_t) {
      lost_ = lost_ || error;
      if (error) return;
      Json json = ws_.got_text() ? Json::parse(beast::buffers_to_string(in_.cdata()), nullptr, false) : Json();
      in_.consume(in_.size());
      const bool is_answer = json.is_object() && (json.contains("answer") || json.contains("error"));
      if (is_answer && json.value("id", Json()).is_number_integer()) {
        const auto id = json["id"].get<std::int64_t>();
        answers.insert_or_assign(id, std::move(json));
      }
      read();
    });
  }

  void write() {
    ws_.text(true);
    ws_.async_write(asio::buffer(out_.front()), [this](boost::system::error_code error, std::size_t) {
      lost_ = lost_ || error;
      if (error) return;
      out_.pop_front();
      if (!out_.empty()) write();
    });
  }

  asio::io_context io_{1};
  websocket::stream<beast::tcp_stream> ws_{io_};
  beast::flat_buffer in_;
  std::deque<std::string> out_;
  bool lost_ = false;
};

BridgeClient::BridgeClient(std::unique_ptr<Link> link) : link_(std::move(link)) {}
BridgeClient::~BridgeClient() = default;

tl::expected<std::unique_ptr<BridgeClient>, std::string> BridgeClient::enter(const std::string& address,
                                                                             const std::string& name) {
  const auto endpoint = endpoint_of(address);
  if (!endpoint) return tl::unexpected("no bridge is at \"" + address + "\"");
  auto link = std::make_unique<Link>();
  if (const auto error = link->open(*endpoint)) {
    return tl::unexpected("the bridge at " + address + " lets nobody in: " + error.message());
  }
  std::unique_ptr<BridgeClient> client(new BridgeClient(std::move(link)));
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = name;
  const std::int64_t id = client->ask(hello);
  client->link_->wait_until([&] { return client->answer(id) != nullptr; });
  const Json* answer = client->answer(id);
  if (answer == nullptr) return tl::unexpected("the bridge at " + address + " does not answer");
  if (answer->contains("error")) return tl::unexpected((*answer)["error"]["message"].get<std::string>());
  return client;
}

void BridgeClient::send(std::string text) { link_->send(std::move(text)); }
void BridgeClient::poll() { link_->poll(); }
const Json* BridgeClient::answer(std::int64_t id) const {
  const auto it = link_->answers.find(id);
  return it != link_->answers.end() ? &it->second : nullptr;
}
bool BridgeClient::lost() const { return link_->lost(); }

}  // namespace concord::hmd
