#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bus/messages.hpp"

namespace concord::test {

/// A good message, and how its type is read.
struct MessageSample {
  std::string type;
  Bytes bytes;
  /// What was read, written again.
  std::function<Decoded<Bytes>(std::span<const std::uint8_t>)> reread;
};

/// At least one of each type.
[[nodiscard]] const std::vector<MessageSample>& message_samples();

}  // namespace concord::test
