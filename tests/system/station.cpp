#include "station.hpp"

#include <chrono>
#include <memory>

#include "bus/messages.hpp"

namespace concord::test {
namespace {

constexpr double kBytesPerSecond = 5e6;

}  // namespace

Station::Station(const Host& host) {
  host.inside([this] { bus_ = std::make_unique<LcmBus>(kUrl, counters_); });
}

StreamCopy::StreamCopy(const Host& host, const std::string& stream, double resolution) : station_(host) {
  const BrickReceiver::Config config = {stream, resolution, 4'000'000};
  const BrickReceiver::Events events = {[this](const std::string&) { map_.clear(); },
                                        [this](BrickIndex index, Brick brick) { map_.set(index, std::move(brick)); },
                                        [this] { map_.clear(); }};
  receiver_ = std::make_unique<BrickReceiver>(bus(), station_.counters(), config, events);
  const StreamChannels channels(stream);
  host.inside([&] {
    listen<BrickPacket>(bus(), station_.counters(), "test", channels.bricks,
                        [this](const std::string&, const BrickPacket& packet) { receiver_->on_packet(packet); });
    listen<BrickDigest>(bus(), station_.counters(), "test", channels.digest,
                        [this](const std::string&, const BrickDigest& packet) { receiver_->on_digest(packet); });
  });
}

StreamSource::StreamSource(const Host& host, const std::string& stream, double resolution, BrickMap map)
    : station_(host), map_(std::move(map)) {
  const BrickSender::Config config = {stream, resolution, kBytesPerSecond, bus().now()};
  host.inside([&] { sender_ = std::make_unique<BrickSender>(bus(), station_.counters(), config, map_); });
  sender_->begin("frame1");
}

void StreamSource::set(BrickIndex index, Brick brick) {
  if (map_.set(index, std::move(brick))) sender_->touch(index);
}

bool eventually(const std::vector<LcmBus*>& buses, const std::function<bool()>& happened) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!happened()) {
    if (std::chrono::steady_clock::now() > until) return false;
    for (LcmBus* bus : buses) bus->spin_once(2);
  }
  return true;
}

}  // namespace concord::test
