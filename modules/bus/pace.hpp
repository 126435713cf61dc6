#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace concord {

/// A token bucket that all senders on one bus share, in turns: what a process says at once must fit into its hearers'
/// buffers, and no sender starves behind a large one.
class Pace {
 public:
  /// Sends one packet and returns what it costs in bytes; 0 when there is nothing to send.
  using SendOne = std::function<double()>;

  /// Takes part until `alive` has gone.
  void join(std::weak_ptr<bool> alive, SendOne send_one) {
    senders_.push_back({std::move(alive), std::move(send_one)});
  }

  /// Lets senders send, packet by packet in turns, what the time that passed has earned.
  void serve(std::int64_t utime, double bytes_per_second);

 private:
  struct Sender {
    std::weak_ptr<bool> alive;
    SendOne send_one;
  };

  std::vector<Sender> senders_;
  std::size_t next_ = 0;
  double budget_ = 0;
  std::int64_t last_ = 0;
};

}  // namespace concord
