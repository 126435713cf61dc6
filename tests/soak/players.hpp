#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "agent/submap_publisher.hpp"
#include "bus/list_stream.hpp"
#include "core/compose.hpp"
#include "stack.hpp"
#include "station.hpp"

namespace concord::soak {

/// Robots that have driven their rounds: they stand and keep their submaps available.
class Robots {
 public:
  Robots(const test::Host& host, const std::map<std::string, BrickMap>& submaps);
  [[nodiscard]] LcmBus& bus() { return station_.bus(); }

 private:
  test::Station station_;
  std::vector<std::unique_ptr<SubmapPublisher>> publishers_;
};

/// What a planner or a headset holds that joins now.
class Observer {
 public:
  explicit Observer(const test::Host& host);
  [[nodiscard]] std::vector<LcmBus*> buses() { return {&map_.bus(), &conflicts_.bus(), &station_.bus()}; }

  /// All streams have arrived whole, and are this.
  [[nodiscard]] bool holds(const MergedMap& expected, const std::map<std::string, Zone>& zones) const;
  /// Of the map.
  [[nodiscard]] std::int64_t revision() const { return map_.receiver().revision(); }
  /// For a person.
  [[nodiscard]] std::string difference(const MergedMap& expected, const std::map<std::string, Zone>& zones) const;

 private:
  [[nodiscard]] bool has_zones(const std::map<std::string, Zone>& zones) const;

  test::StreamCopy map_;
  test::StreamCopy conflicts_;
  test::Station station_;
  std::unique_ptr<ListReceiver<Zone>> zones_;
};

/// Kills a process (SIGKILL) shortly after some requests were sent: the moments at which something can be half
/// done. Starts it again soon after.
class Assassin {
 public:
  Assassin(test::Stack& stack, int kills, int requests, std::uint32_t seed);

  /// `number` requests were sent by `now`.
  void on_request(int number, std::int64_t now);
  /// Kills who is due, and starts again whom it killed a moment before.
  void act(std::int64_t now);
  [[nodiscard]] bool done() const { return due_.empty() && !down_; }
  /// By process.
  [[nodiscard]] const std::map<std::string, int>& kills() const { return kills_; }

 private:
  [[nodiscard]] std::int64_t pick(std::int64_t low, std::int64_t high);

  test::Stack& stack_;
  std::mt19937 random_;
  std::multiset<int> after_;         ///< numbers of the requests that a kill follows
  std::multiset<std::int64_t> due_;  ///< when
  std::optional<std::string> down_;
  std::int64_t back_at_ = 0;
  std::map<std::string, int> kills_;
};

}  // namespace concord::soak
