#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/brick_stream.hpp"
#include "bus/lockstep_bus.hpp"

namespace concord {

/// What is missing in a recording. A logger cannot ask for what it missed: it shows as versions of a brick stream that
/// were announced but never came, and as clouds whose number never came. What another release or another site recorded
/// and this one cannot take is missing as well.
class StreamGaps {
 public:
  struct Gap {
    std::string channel;
    std::optional<std::int64_t> missing;  ///< how many; absent where nobody can know
    std::string what;                     ///< is missing, in words that follow the number
  };

  /// @pre `start` is not after the first message.
  StreamGaps(double resolution, std::int64_t start) : resolution_(resolution), bus_(start) {}

  void hear(std::int64_t utime, const std::string& channel, std::span<const std::uint8_t> bytes);

  /// Sorted by channel; one may have several. What was made void (a frame that was left) counts no more.
  [[nodiscard]] std::vector<Gap> gaps() const;

 private:
  struct Clouds {
    std::string frame_id;
    /// By frame_id and start of the sender: sequence numbers, plus 1.
    std::map<std::string, std::map<std::int64_t, VersionSet>> heard;
  };

  BrickReceiver& receiver(const std::string& stream);
  void unreadable(const std::string& channel) { ++unreadable_[channel]; }

  double resolution_;
  LockstepBus bus_;  ///< its receivers ask for repairs, and nobody hears them
  Counters counters_;
  std::map<std::string, std::unique_ptr<BrickReceiver>> streams_;
  std::map<std::string, Clouds> clouds_;
  std::map<std::string, std::int64_t> unreadable_;  ///< by channel
};

}  // namespace concord
