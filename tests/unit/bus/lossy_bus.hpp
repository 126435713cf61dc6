#pragma once

#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bus/lockstep_bus.hpp"

namespace concord::test {

/// Numbers that are the same on each run.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  std::uint32_t roll(std::uint32_t below) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<std::uint32_t>((state_ >> 33) % below);
  }

 private:
  std::uint64_t state_;
};

/// What happens to messages on their way to one station, in percent.
struct Link {
  std::uint32_t lost = 0;
  std::uint32_t doubled = 0;
  std::uint32_t late = 0;  ///< by up to 100 ms, so overtaken by others
};

/// One station on a shared medium: what it hears is lost, doubled and out of order, independently of other stations.
class LossyBus final : public Bus {
 public:
  LossyBus(LockstepBus& air, Link link, std::uint64_t seed) : air_(air), link_(link), dice_(seed) {
    air_.every(1'000, [this, alive = std::weak_ptr(alive_)] {
      if (!alive.expired()) deliver_late();
    });
  }

  using Bus::every, Bus::subscribe;
  void subscribe(const std::string& channel_regex, Handler handler, int queued, Owner owner) override {
    const Handler* kept = handlers_.emplace_back(std::make_unique<Handler>(std::move(handler))).get();
    const auto hear = [this, kept, alive = std::weak_ptr(alive_)](const std::string& channel, auto bytes) {
      if (!alive.expired()) arrive(*kept, channel, {bytes.begin(), bytes.end()});
    };
    air_.subscribe(channel_regex, hear, queued, std::move(owner));
  }
  void publish(const std::string& channel, std::span<const std::uint8_t> bytes) override {
    bytes_sent_ += bytes.size();
    air_.publish(channel, bytes);
  }
  void every(std::int64_t period, Task task, Owner owner) override {
    air_.every(period, std::move(task), std::move(owner));
  }
  [[nodiscard]] std::int64_t now() const override { return air_.now(); }

  [[nodiscard]] std::size_t bytes_sent() const { return bytes_sent_; }

 private:
  struct Late {
    std::int64_t due;
    const Handler* handler;
    std::string channel;
    Bytes bytes;
  };

  void arrive(const Handler& handler, const std::string& channel, Bytes bytes) {
    if (dice_.roll(100) < link_.lost) return;
    const int copies = dice_.roll(100) < link_.doubled ? 2 : 1;
    for (int i = 0; i < copies; ++i) {
      if (dice_.roll(100) < link_.late) {
        late_.push_back({now() + dice_.roll(100'000), &handler, channel, bytes});
      } else {
        handler(channel, bytes);
      }
    }
  }

  void deliver_late() {
    for (std::size_t i = late_.size(); i > 0; --i) {
      Late message = std::move(late_.front());
      late_.pop_front();
      if (message.due <= now()) {
        (*message.handler)(message.channel, message.bytes);
      } else {
        late_.push_back(std::move(message));
      }
    }
  }

  LockstepBus& air_;
  Link link_;
  Dice dice_;
  std::vector<std::unique_ptr<Handler>> handlers_;
  std::deque<Late> late_;
  std::size_t bytes_sent_ = 0;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< the medium outlives its stations
};

}  // namespace concord::test
