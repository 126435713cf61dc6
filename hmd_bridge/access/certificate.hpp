#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace concord::hmd {

/// A self-signed certificate and its key, as PEM.
struct Certificate {
  std::string certificate;
  std::string key;
  std::string fingerprint;  ///< SHA-256, as browsers show it: AB:CD:...
};

/// For a server that is reached by these names and addresses: P-256, good from `now` (seconds since 1970) less a day
/// for 397 days, the most that browsers accept. Refused: no name, one that is neither a host name nor an address
/// (kBadName), no randomness (kIo).
[[nodiscard]] Result<Certificate> make_certificate(const std::vector<std::string>& names, std::int64_t now);

}  // namespace concord::hmd
