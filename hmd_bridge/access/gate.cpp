#include "access/gate.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace concord::hmd {
namespace {

constexpr double kTriesPerSecond = 1, kTriesAtOnce = 30;
constexpr double kDevices = 8;  ///< of a building that come in at once, in its one IPv6 network
constexpr double kLinesPerSecond = 1, kLinesAtOnce = 100;
constexpr double kRequestsPerSecond = 100, kRequestsAtOnce = 1000;
constexpr double kBytesPerSecond = 16e6, kBytesAtOnce = 256e6;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Of buckets that are kept for each, `fresh` at first. Those that are full need not be kept.
bool take(std::map<std::string, TokenBucket>& buckets, const std::string& whose, const TokenBucket& fresh,
          double amount, std::int64_t now) {
  if (buckets.size() >= Gate::kMaxAddresses && !buckets.contains(whose)) {
    std::erase_if(buckets, [now](const auto& entry) { return entry.second.full(now); });
    if (buckets.size() >= Gate::kMaxAddresses) return false;
  }
  return buckets.try_emplace(whose, fresh).first->second.take(amount, now);
}

}  // namespace

bool is_loopback(const std::string& address) {
  return address == "::1" || address.starts_with("127.") || address.starts_with("::ffff:127.");
}

std::string network_of(const std::string& address) {
  std::array<char, 16> bytes{};
  const bool mapped = address.starts_with("::ffff:");
  const std::string number = address.substr(0, address.find('%'));  // behind it: by which interface
  if (mapped || inet_pton(AF_INET6, number.c_str(), bytes.data()) != 1) return address;
  return {bytes.data(), 8};
}

bool is_local_host(const std::string& host) {
  const std::size_t end = host.starts_with('[') ? host.find(']') + 1 : std::min(host.find(':'), host.size());
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const std::string name = lower(host.substr(0, end)), port = host.substr(end);
  if (!port.empty() && (port[0] != ':' || !std::all_of(port.begin() + 1, port.end(), is_digit))) return false;
  const bool dotted = std::all_of(name.begin(), name.end(), [&](char c) { return is_digit(c) || c == '.'; });
  return name == "localhost" || name == "[::1]" || (dotted && name.starts_with("127."));
}

bool origin_allowed(const std::string& origin, const std::string& scheme, const std::string& host,
                    const std::vector<std::string>& also) {
  if (origin.empty()) return true;
  const std::string from = lower(origin);
  if (!host.empty() && from == scheme + "://" + lower(host)) return true;
  return std::any_of(also.begin(), also.end(), [&](const std::string& allowed) { return lower(allowed) == from; });
}

bool Gate::may_try(const std::string& address, std::int64_t now) {
  const TokenBucket of_one(kTriesPerSecond, kTriesAtOnce);
  const TokenBucket of_network(kDevices * kTriesPerSecond, kDevices * kTriesAtOnce);
  const std::string network = network_of(address);
  if (network != address && !take(tries_, network, of_network, 1, now)) return false;
  return take(tries_, address, of_one, 1, now);
}

bool Gate::may_ask(const std::string& address, std::int64_t now) {
  return take(asked_, network_of(address), TokenBucket(kRequestsPerSecond, kRequestsAtOnce), 1, now);
}

bool Gate::may_be_noted(const std::string& address, std::int64_t now) {
  return take(noted_, network_of(address), TokenBucket(kLinesPerSecond, kLinesAtOnce), 1, now);
}

bool Gate::may_take(const std::string& address, std::size_t bytes, std::int64_t now) {
  return take(taken_, network_of(address), TokenBucket(kBytesPerSecond, kBytesAtOnce), static_cast<double>(bytes), now);
}

std::optional<std::string> Gate::issue(const Identity& identity, std::int64_t now) {
  std::erase_if(tickets_, [now](const auto& entry) { return entry.second.until <= now; });
  if (tickets_.size() >= kMaxTickets) return std::nullopt;
  std::string ticket = new_secret_();
  tickets_[ticket] = {identity, now + kTicketLife};
  return ticket;
}

std::optional<Identity> Gate::redeem(const std::string& ticket, std::int64_t now) {
  const auto it = tickets_.find(ticket);
  if (it == tickets_.end()) return std::nullopt;
  const Ticket found = it->second;
  tickets_.erase(it);
  if (found.until <= now) return std::nullopt;
  return found.identity;
}

}  // namespace concord::hmd
