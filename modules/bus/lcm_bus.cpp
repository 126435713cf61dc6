#include "bus/lcm_bus.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <fstream>

#include <spdlog/spdlog.h>

#include "bus/lcm_url.hpp"
#include "bus/site.hpp"

namespace concord {
namespace {

constexpr int kReceiveBuffer = 4 << 20;

/// LCM takes the socket buffer from the url; the default loses most of a burst.
std::string with_receive_buffer(const std::string& url) {
  if (url.rfind("udpm", 0) != 0 || url.find("recv_buf_size") != std::string::npos) return url;
  return url + (url.find('?') == std::string::npos ? "?" : "&") + "recv_buf_size=" + std::to_string(kReceiveBuffer);
}

const std::string& checked(const std::string& url) {
  if (const auto usable = check_lcm_url(url); !usable) throw ConfigError(usable.error().message);
  return url;
}

void warn_about_small_buffers(const std::string& url) {
  if (url.rfind("udpm", 0) != 0) return;
  long allowed = 0;
  std::ifstream("/proc/sys/net/core/rmem_max") >> allowed;
  if (allowed > 0 && allowed < kReceiveBuffer) {
    spdlog::warn(
        "net.core.rmem_max is {}: whole octomaps over {} kB may not arrive; run: sysctl -w net.core.rmem_max={}",
        allowed, allowed / 1000, kReceiveBuffer);
  }
}

std::int64_t microseconds(std::chrono::nanoseconds time) {
  return std::chrono::duration_cast<std::chrono::microseconds>(time).count();
}

/// LCM anchors a pattern without brackets, so that only the ends of an alternation would be.
std::string anchored(const std::string& channel_regex) {
  return channel_regex.find('|') == std::string::npos ? channel_regex : "(?:" + channel_regex + ")";
}

}  // namespace

LcmBus::LcmBus(const std::string& url, Counters& counters)
    : lcm_(with_receive_buffer(checked(url))),
      start_(microseconds(std::chrono::system_clock::now().time_since_epoch())),
      steady_start_(std::chrono::steady_clock::now()),
      counters_(counters) {
  if (!lcm_.good()) {
    throw ConfigError("LCM cannot join " + url + "; is there a multicast route? (ip route add 224.0.0.0/4 dev lo)");
  }
  warn_about_small_buffers(url);
}

LcmBus::~LcmBus() = default;

void LcmBus::subscribe(const std::string& channel_regex, Handler handler, int queued, Owner owner) {
  Subscription& subscription =
      subscriptions_.emplace_back(Subscription{this, std::move(handler), std::move(owner), nullptr});
  subscription.raw = lcm_.subscribe(anchored(channel_regex), &Subscription::receive, &subscription);
  assert(queued > 0);  // LCM takes 0 for no limit
  subscription.raw->setQueueCapacity(queued);
}

void LcmBus::Subscription::receive(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
  const std::span bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
  if (owner.expired()) return;
  if (!is_channel(channel)) return bus->counters_.add("refused.channel_name");
  bus->guarded(channel, [&] { handler(channel, bytes); });
}

void LcmBus::publish(const std::string& channel, std::span<const std::uint8_t> bytes) {
  assert(channel.size() <= kMaxChannel);
  if (lcm_.publish(channel, bytes.data(), static_cast<unsigned>(bytes.size())) != 0) counters_.add("publish_failed");
}

void LcmBus::every(std::int64_t period, Task task, Owner owner) {
  timers_.push_back({period, now() + period, std::move(task), std::move(owner)});
}

std::int64_t LcmBus::now() const { return start_ + microseconds(std::chrono::steady_clock::now() - steady_start_); }

/// Not while a handler or task runs: it may be theirs.
void LcmBus::forget_the_gone() {
  std::erase_if(timers_, [](const Timer& timer) { return timer.owner.expired(); });
  std::erase_if(subscriptions_, [this](const Subscription& subscription) {
    if (!subscription.owner.expired()) return false;
    lcm_.unsubscribe(subscription.raw);
    return true;
  });
}

void LcmBus::spin_once(int timeout_ms) {
  forget_the_gone();
  std::int64_t wait = std::int64_t{timeout_ms} * 1000;
  for (const Timer& timer : timers_) wait = std::min(wait, timer.due - now());
  wait = std::clamp<std::int64_t>(wait, 0, std::int64_t{timeout_ms} * 1000);
  // Timers must run under load too: at most a few milliseconds of messages between them.
  const std::int64_t until = now() + wait + 5000;
  int timeout = static_cast<int>((wait + 999) / 1000);
  while (lcm_.handleTimeout(timeout) > 0 && now() < until) timeout = 0;
  run_due_timers();
}

/// In the order of `every`; each at most once, and after a stall the missed ones are not made up for.
void LcmBus::run_due_timers() {
  for (Timer& timer : timers_) {
    const std::int64_t time = now();
    if (time < timer.due || timer.owner.expired()) continue;
    timer.due += timer.period * ((time - timer.due) / timer.period + 1);
    guarded("timer", timer.task);
  }
}

/// An exception that left a handler would break LCM's next handle().
void LcmBus::guarded(const std::string& what, const Task& task) {
  try {
    task();
  } catch (const std::exception& e) {
    counters_.add("exceptions");
    spdlog::error("exception on {}: {}", what, e.what());
  } catch (...) {
    counters_.add("exceptions");
    spdlog::error("exception on {}", what);
  }
}

}  // namespace concord
