#include "bus/pace.hpp"

#include <algorithm>

namespace concord {
namespace {

/// After a pause: well inside a default socket buffer.
constexpr double kBurstBytes = 100'000;

}  // namespace

void Pace::serve(std::int64_t utime, double bytes_per_second) {
  if (last_ != 0) budget_ += bytes_per_second * static_cast<double>(std::max<std::int64_t>(0, utime - last_)) * 1e-6;
  budget_ = std::min(budget_, kBurstBytes);
  last_ = utime;
  std::erase_if(senders_, [](const Sender& sender) { return sender.alive.expired(); });
  for (std::size_t idle = 0; budget_ > 0 && idle < senders_.size();) {
    if (next_ >= senders_.size()) next_ = 0;
    const double cost = senders_[next_++].send_one();
    budget_ -= cost;
    idle = cost > 0 ? 0 : idle + 1;
  }
}

}  // namespace concord
