#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "protocol/control.hpp"

namespace concord::hmd {

/// A person's program on the bridge's own machine, without TLS: says hello, asks, takes answers. It looks at nothing,
/// so it gives no credit and no blocks come. The bridge's own user is the demo; hmd.v1 in another language begins so
/// too.
class BridgeClient {
 public:
  /// Connects to `http://ADDRESS:PORT/` and says hello as `name`. Waits at most 5 s for each.
  /// Refused with what went wrong, for a person.
  [[nodiscard]] static tl::expected<std::unique_ptr<BridgeClient>, std::string> enter(const std::string& address,
                                                                                      const std::string& name);
  ~BridgeClient();
  BridgeClient(const BridgeClient&) = delete;
  BridgeClient& operator=(const BridgeClient&) = delete;

  /// Sends a request. @return its id.
  template <class Request>
  std::int64_t ask(const Request& request) {
    const std::int64_t id = ++last_id_;
    send(request_text(id, request));
    return id;
  }
  /// Takes what has come, without waiting.
  void poll();
  /// `{"id", "answer"}` or `{"id", "error"}`, once it has come; null until then.
  [[nodiscard]] const Json* answer(std::int64_t id) const;
  /// The connection has ended: no more answers come.
  [[nodiscard]] bool lost() const;

 private:
  class Link;

  explicit BridgeClient(std::unique_ptr<Link> link);
  void send(std::string text);

  std::unique_ptr<Link> link_;
  std::int64_t last_id_ = 0;
};

}  // namespace concord::hmd
