#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "access/token_bucket.hpp"
#include "protocol/messages.hpp"

namespace concord::hmd {

/// Who a client is: by its ticket, or by being on this machine.
struct Identity {
  std::string name;
  Role role = Role::kView;
  std::string token = {};  ///< its SHA-256 in hex; empty: none was needed
  bool operator==(const Identity&) const = default;
};

/// Whether a client of this role may do what needs that one.
[[nodiscard]] inline bool may(Role has, Role needs) { return has >= needs; }

/// Whether an address (as text, without port) is this machine's own.
[[nodiscard]] bool is_loopback(const std::string& address);

/// Whether a Host header names this machine itself. A page from elsewhere whose name was made to resolve to this
/// machine (DNS rebinding) comes from loopback too, but its browser says its own name here.
[[nodiscard]] bool is_local_host(const std::string& host);

/// Whoever has an address is likely to have all of this: the address, or the first 64 bits of an IPv6 one.
[[nodiscard]] std::string network_of(const std::string& address);

/// What a browser says of where a page came from: allowed are none (no browser), the server itself as `scheme` and the
/// Host header name it, and those that the site file lists, each as "https://name" or "https://name:port". Without
/// case.
[[nodiscard]] bool origin_allowed(const std::string& origin, const std::string& scheme, const std::string& host,
                                  const std::vector<std::string>& also);

/// One-use tickets, and how often a network may do what. Everything it keeps is bounded.
class Gate {
 public:
  static constexpr std::int64_t kTicketLife = 10'000'000;  ///< microseconds
  static constexpr std::size_t kMaxTickets = 1000;
  static constexpr std::size_t kMaxAddresses = 10'000;

  /// `new_secret` answers a text that nobody can guess, another one each time.
  explicit Gate(std::function<std::string()> new_secret) : new_secret_(std::move(new_secret)) {}

  /// Whether this address may try (a token, a connection) once more: 1 a second, 30 at once; all addresses of an IPv6
  /// network together eight times that.
  [[nodiscard]] bool may_try(const std::string& address, std::int64_t now);
  /// Whether it may send one HTTP request more: 100 a second, 1,000 at once.
  [[nodiscard]] bool may_ask(const std::string& address, std::int64_t now);
  /// Whether one more refusal of it is worth a line of the log: 1 a second, 100 at once.
  [[nodiscard]] bool may_be_noted(const std::string& address, std::int64_t now);
  /// Whether this network may have so much of files and models now: 16 MB a second, 256 MB at once.
  [[nodiscard]] bool may_take(const std::string& address, std::size_t bytes, std::int64_t now);
  /// A ticket for who has shown a token; nothing while kMaxTickets wait.
  [[nodiscard]] std::optional<std::string> issue(const Identity& identity, std::int64_t now);
  /// Whose ticket it is; nobody's once it was used or kTicketLife is over.
  [[nodiscard]] std::optional<Identity> redeem(const std::string& ticket, std::int64_t now);

  [[nodiscard]] std::string new_secret() const { return new_secret_(); }

 private:
  struct Ticket {
    Identity identity;
    std::int64_t until;
  };

  std::function<std::string()> new_secret_;
  std::map<std::string, Ticket> tickets_;
  using Buckets = std::map<std::string, TokenBucket>;  ///< by network
  Buckets tries_, asked_, noted_, taken_;
};

}  // namespace concord::hmd
