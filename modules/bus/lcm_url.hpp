#pragma once

#include <string>

#include "core/error.hpp"

namespace concord {

/// Whether LCM can use this url: LCM itself passes over what it does not understand, or says nothing of why it fails.
/// Refused (kMalformed), with what is wrong and what is right: another scheme than LCM's; of "udpm" an address that is
/// not IPv4 multicast, a port that is none, a ttl that is no number of 0 to 255.
[[nodiscard]] Result<void> check_lcm_url(const std::string& url);

}  // namespace concord
