#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bus/messages.hpp"

namespace concord::test {

/// One good message of each type, and how it is read.
struct MessageSample {
  std::string type;
  Bytes bytes;
  /// What was read, written again.
  std::function<Decoded<Bytes>(std::span<const std::uint8_t>)> reread;
};

inline constexpr double kSampleResolution = 0.05;

[[nodiscard]] const std::vector<MessageSample>& message_samples();

}  // namespace concord::test
