#pragma once

// Private to the server's files: Beast. What is answered to an HTTP request.

#include <memory>
#include <optional>
#include <string>
#include <variant>

// Of a model that is sent, so much is read at once.
#define BOOST_BEAST_FILE_BUFFER_SIZE 65536
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

#include "server/server_core.hpp"

namespace concord::hmd {

namespace beast = boost::beast;
namespace http = beast::http;

using Request = http::request<http::string_body>;

/// An answer whose body is in memory, held and not copied; or one that is read from disk while it is sent.
struct Reply {
  using Held = http::response<http::span_body<const char>>;
  using FromDisk = http::response<http::file_body>;
  std::variant<Held, FromDisk> response;
  std::shared_ptr<const std::string> body = nullptr;  ///< that a Held one shows

  [[nodiscard]] http::status status() const {
    return std::visit([](const auto& r) { return r.result(); }, response);
  }
};

[[nodiscard]] std::string field(const Request& request, http::field name);
[[nodiscard]] Reply answer(Server::Core& core, const Request& request, const Peer& peer);
/// Why a WebSocket is refused; nothing: it is not.
[[nodiscard]] std::optional<Reply> refusal(Server::Core& core, const Request& request, const Peer& peer);

}  // namespace concord::hmd
