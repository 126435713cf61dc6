#pragma once

#include <string_view>

namespace concord {

/// Well-formed UTF-8 (RFC 3629) without zero bytes, at which LCM's encoder would cut: what JSON, logs and databases may
/// be given. One rule for what comes over the bus and what comes from files, so that what was read can be sent.
[[nodiscard]] bool is_utf8(std::string_view text);

/// UTF-8 without control characters: what people give and get back in answers, logs and lists.
[[nodiscard]] bool is_printable(std::string_view text);

/// Of requests, and so of edits and leases: 1 to 80 printable bytes.
[[nodiscard]] bool is_request_id(std::string_view text);

}  // namespace concord
