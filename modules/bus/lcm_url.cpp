#include "bus/lcm_url.hpp"

#include <arpa/inet.h>

#include <array>
#include <charconv>
#include <optional>
#include <string_view>

namespace concord {
namespace {

constexpr const char* kExample = "udpm://239.255.76.67:7667?ttl=0";

tl::unexpected<Error> wrong(const std::string& url, const std::string& what) {
  return refuse(Code::kMalformed, "lcm_url " + url + " " + what + "; a right one is " + kExample);
}

std::optional<int> number_of(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && value >= 0 ? std::optional(value) : std::nullopt;
}

bool is_multicast(const std::string& address) {
  in_addr parsed = {};
  return inet_pton(AF_INET, address.c_str(), &parsed) == 1 && (ntohl(parsed.s_addr) >> 28) == 0xE;
}

Result<void> check_multicast(const std::string& url, std::string_view rest) {
  const std::size_t query = std::min(rest.find('?'), rest.size());
  const std::string_view network = rest.substr(0, query);
  const std::size_t colon = std::min(network.find(':'), network.size());
  const std::string address(network.substr(0, colon));
  if (!is_multicast(address)) {
    return wrong(url, "has the address '" + address + "', which is no multicast one (224.0.0.0 to 239.255.255.255)");
  }
  const std::string_view port = network.substr(std::min(colon + 1, network.size()));
  const std::optional<int> number = number_of(port);
  if (!number || *number < 1 || *number > 65535) {
    return wrong(url, "has the port '" + std::string(port) + "', which must lie between 1 and 65535");
  }
  for (std::string_view options = rest.substr(std::min(query + 1, rest.size())); !options.empty();) {
    const std::size_t end = std::min(options.find('&'), options.size());
    const std::string_view option = options.substr(0, end);
    const bool is_ttl = option.starts_with("ttl=");
    const std::optional<int> ttl = is_ttl ? number_of(option.substr(4)) : std::nullopt;
    if (is_ttl && (!ttl || *ttl > 255)) return wrong(url, "has a ttl that is no number of 0 to 255");
    options.remove_prefix(std::min(end + 1, options.size()));
  }
  return {};
}

}  // namespace

Result<void> check_lcm_url(const std::string& url) {
  const std::size_t end = url.find("://");
  if (end == std::string::npos) return wrong(url, "is no url");
  const std::string scheme = url.substr(0, end);
  if (scheme == "udpm" || scheme == "mpudpm") return check_multicast(url, std::string_view(url).substr(end + 3));
  for (const char* other : {"memq", "tcpq", "file"}) {
    if (scheme == other) return {};
  }
  return wrong(url, "begins with '" + scheme + "', which is none of udpm, mpudpm, tcpq, memq and file");
}

}  // namespace concord
