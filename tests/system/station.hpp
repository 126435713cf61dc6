#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bus/brick_stream.hpp"
#include "bus/counters.hpp"
#include "bus/lcm_bus.hpp"
#include "core/brick_map.hpp"
#include "network.hpp"

namespace concord::test {

/// Packets cross one switch and no router.
inline const std::string kUrl = "udpm://239.255.76.67:7667?ttl=1";

/// The test's own ear and mouth on a host.
class Station {
 public:
  explicit Station(const Host& host);
  [[nodiscard]] LcmBus& bus() { return *bus_; }
  [[nodiscard]] Counters& counters() { return counters_; }

 private:
  Counters counters_;
  std::unique_ptr<LcmBus> bus_;
};

/// A copy of a stream, as any consumer keeps it.
class StreamCopy {
 public:
  StreamCopy(const Host& host, const std::string& stream, double resolution);

  [[nodiscard]] LcmBus& bus() { return station_.bus(); }
  [[nodiscard]] const BrickMap& map() const { return map_; }
  [[nodiscard]] bool synced() const { return receiver_->heard() && receiver_->synced(); }
  [[nodiscard]] const BrickReceiver& receiver() const { return *receiver_; }

 private:
  Station station_;
  BrickMap map_;
  std::unique_ptr<BrickReceiver> receiver_;
};

/// A stream and its owner.
class StreamSource {
 public:
  StreamSource(const Host& host, const std::string& stream, double resolution, BrickMap map);

  [[nodiscard]] LcmBus& bus() { return station_.bus(); }
  [[nodiscard]] const BrickMap& map() const { return map_; }
  [[nodiscard]] BrickSender& sender() { return *sender_; }
  void set(BrickIndex index, Brick brick);

 private:
  Station station_;
  BrickMap map_;
  std::unique_ptr<BrickSender> sender_;
};

/// Serves the buses until `happened` or a minute has passed. Returns whether it happened.
[[nodiscard]] bool eventually(const std::vector<LcmBus*>& buses, const std::function<bool()>& happened);

}  // namespace concord::test
