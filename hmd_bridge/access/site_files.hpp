#pragma once

#include <filesystem>

#include "bus/site.hpp"

namespace concord::hmd {

/// Where the bridge's certificate, key and tokens are, and while it runs where it is reached: a line each for people
/// and for programs of its own network, often the same.
[[nodiscard]] inline std::filesystem::path certificate_file(const Site& site) {
  return site.bridge.certificate.empty() ? site.state / "bridge" / "cert.pem" : site.bridge.certificate;
}
[[nodiscard]] inline std::filesystem::path key_file(const Site& site) {
  return site.bridge.key.empty() ? site.state / "bridge" / "key.pem" : site.bridge.key;
}
[[nodiscard]] inline std::filesystem::path token_file(const Site& site) { return site.state / "bridge" / "tokens.db"; }
[[nodiscard]] inline std::filesystem::path address_file(const Site& site) { return site.state / "bridge" / "address"; }

}  // namespace concord::hmd
