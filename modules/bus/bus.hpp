#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include "bus/pace.hpp"
#include "core/byte_stream.hpp"

namespace concord {

/// Whether a channel is one that our processes use: printable, without spaces. Names go into counters, logs and JSON,
/// and anyone can send one; messages on others are dropped.
[[nodiscard]] inline bool is_channel(std::string_view name) {
  return std::all_of(name.begin(), name.end(), [](char c) { return c > 0x20 && c < 0x7F; });
}

/// What a node sees of the network: named channels, a clock and timers. Everything runs in one thread.
/// `LcmBus` is the real one; `LockstepBus` plays a log through nodes in one process on log time.
class Bus {
 public:
  using Handler = std::function<void(const std::string& channel, std::span<const std::uint8_t> bytes)>;
  using Task = std::function<void()>;
  /// Something that lives as long as what a subscription or timer is for: when it has gone, the bus forgets that
  /// between two messages. So what comes and goes costs nothing once it has gone, and may go within its own handler.
  using Owner = std::weak_ptr<const void>;

  Bus() = default;
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  virtual ~Bus() = default;

  /// Messages that wait for one subscriber unless it says otherwise: a second of brick packets at the fastest pace
  /// seen without loss. Bounded, so that a stalled process drops (and asks again) instead of growing.
  static constexpr int kQueued = 16'384;

  static constexpr std::size_t kMaxChannel = 63;  ///< characters, by LCM

  /// Calls `handler` with each message on a channel whose whole name matches the regular expression, until `owner` has
  /// gone. `queued`: how many may wait while the process is busy, further ones are dropped; times the largest message
  /// it is the memory at risk.
  virtual void subscribe(const std::string& channel_regex, Handler handler, int queued, Owner owner) = 0;
  /// For as long as the bus lives.
  void subscribe(const std::string& channel_regex, Handler handler, int queued = kQueued) {
    subscribe(channel_regex, std::move(handler), queued, self_);
  }
  /// Never blocks on receivers. @pre channel has at most kMaxChannel characters.
  virtual void publish(const std::string& channel, std::span<const std::uint8_t> bytes) = 0;
  /// Calls `task` about every `period` microseconds, first after one period, until `owner` has gone.
  virtual void every(std::int64_t period, Task task, Owner owner) = 0;
  /// For as long as the bus lives.
  void every(std::int64_t period, Task task) { every(period, std::move(task), self_); }
  /// Microseconds since 1970; in a replay the log's time.
  [[nodiscard]] virtual std::int64_t now() const = 0;

  /// What all streams that are sent on this bus share.
  [[nodiscard]] Pace& pace() { return pace_; }

 private:
  Pace pace_;
  std::shared_ptr<bool> self_ = std::make_shared<bool>(true);
};

}  // namespace concord
