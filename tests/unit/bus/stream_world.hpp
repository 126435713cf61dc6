#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bus/brick_stream.hpp"
#include "core/brick_codec.hpp"
#include "lossy_bus.hpp"

namespace concord::test {

inline const std::string kStream = "in/robot1";
inline constexpr double kResolution = 0.05;

/// A brick that no codec can shorten much: about `known` / 100 of 1 kB.
inline Brick noisy_brick(std::uint64_t seed, std::uint32_t known_percent = 50) {
  Dice dice(seed);
  DenseBrick dense;
  for (LogOdds& value : dense) {
    value = dice.roll(100) < known_percent ? static_cast<LogOdds>(dice.roll(8000)) : kUnknown;
  }
  return Brick::from_dense(dense);
}

inline BrickPacket packet(std::int64_t boot_id, std::int64_t first, std::int64_t last) {
  return {0, boot_id, "frame", kResolution, first, last, 0, {}};
}

/// A packet that holds one brick, as a sender would write it.
inline BrickPacket packet_with(std::int64_t boot_id, std::int64_t version, BrickIndex index, const Brick& brick) {
  BrickPacket out = packet(boot_id, version, version);
  out.count = 1;
  append_varint(out.data, 0);
  for (const std::int32_t c : {index.x, index.y, index.z}) append_varint(out.data, zigzag(c));
  append_brick(out.data, brick);
  return out;
}

/// A copy of a stream, as any consumer keeps it.
class Copy {
 public:
  Copy(LockstepBus& air, Link link, std::uint64_t seed, std::int64_t max_bricks = 4'000'000)
      : bus_(air, link, seed), receiver_(bus_, counters_, {kStream, kResolution, max_bricks}, events()) {
    const StreamChannels channels(kStream);
    listen<BrickPacket>(bus_, counters_, "test", channels.bricks,
                        [this](const std::string&, const BrickPacket& packet) { receiver_.on_packet(packet); });
    listen<BrickDigest>(bus_, counters_, "test", channels.digest,
                        [this](const std::string&, const BrickDigest& digest) { receiver_.on_digest(digest); });
  }
  /// A consumer that starts with what it had on disk.
  Copy(LockstepBus& air, Link link, std::uint64_t seed, const std::string& frame_id, BrickMap map)
      : Copy(air, link, seed) {
    map_ = std::move(map);
    receiver_.adopt(frame_id, map_);
  }

  [[nodiscard]] const BrickMap& map() const { return map_; }
  [[nodiscard]] BrickReceiver& receiver() { return receiver_; }
  [[nodiscard]] Counters& counters() { return counters_; }
  [[nodiscard]] int frames() const { return frames_; }
  [[nodiscard]] int ends() const { return ends_; }
  [[nodiscard]] int changes() const { return changes_; }
  [[nodiscard]] std::size_t least_bricks() const { return least_bricks_; }
  /// Bricks handed on though they were as before.
  [[nodiscard]] int idle_changes() const { return idle_changes_; }
  [[nodiscard]] std::size_t bytes_sent() const { return bus_.bytes_sent(); }

 private:
  BrickReceiver::Events events() {
    return {[this](const std::string&) {
              ++frames_;
              map_.clear();
            },
            [this](BrickIndex index, Brick brick) {
              ++changes_;
              if (!map_.set(index, std::move(brick))) ++idle_changes_;
              least_bricks_ = std::min(least_bricks_, map_.brick_count());
            },
            [this] {
              ++ends_;
              map_.clear();
            }};
  }

  Counters counters_;
  BrickMap map_;
  int frames_ = 0, ends_ = 0, changes_ = 0, idle_changes_ = 0;
  std::size_t least_bricks_ = SIZE_MAX;
  LossyBus bus_;
  BrickReceiver receiver_;
};

/// A stream's owner and its copies, on a clock that the test moves.
class StreamWorld {
 public:
  static constexpr std::int64_t kSecond = 1'000'000;

  explicit StreamWorld(Link link = {}, double bytes_per_second = 5e6) : link_(link), pace_(bytes_per_second) {
    restart_sender();
  }

  void set(BrickIndex index, Brick brick) {
    if (map_.set(index, std::move(brick)) && !frame_.empty()) sender_->touch(index);
  }
  void begin(const std::string& frame_id) {
    frame_ = frame_id;
    sender_->begin(frame_id);
  }
  void end() {
    frame_.clear();
    sender_->end();
  }
  void clear() {
    for (const BrickIndex index : map_.sorted_bricks()) set(index, Brick());
  }
  /// The owner dies and starts again with what is in map().
  void restart_sender() {
    run(1'000);  // a start takes time, so that boot ids differ
    boot_id_ = air_.now();
    earlier_bytes_ += sender_bus_ != nullptr ? sender_bus_->bytes_sent() : 0;
    sender_.reset();
    sender_bus_ = std::make_unique<LossyBus>(air_, link_, ++seed_);
    const BrickSender::Config config{kStream, kResolution, pace_, boot_id_};
    sender_ = std::make_unique<BrickSender>(*sender_bus_, sender_counters_, config, map_);
    if (!frame_.empty()) sender_->begin(frame_);
  }

  Copy& join() { return *copies_.emplace_back(std::make_unique<Copy>(air_, link_, ++seed_)); }
  /// A consumer dies and starts again, with what it had or with nothing.
  void restart_copy(std::size_t i, bool adopt) {
    const std::string frame_id = copies_[i]->receiver().frame_id();
    const BrickMap map = copies_[i]->map();
    copies_[i].reset();
    copies_[i] = adopt && !frame_id.empty() ? std::make_unique<Copy>(air_, link_, ++seed_, frame_id, map)
                                            : std::make_unique<Copy>(air_, link_, ++seed_);
  }

  void run(std::int64_t microseconds) { air_.advance_to(air_.now() + microseconds); }
  [[nodiscard]] bool settled() {
    if (!sender_->idle()) return false;
    for (const auto& copy : copies_) {
      if (!copy->receiver().synced() || copy->receiver().revision() != sender_->revision()) return false;
      if (copy->receiver().frame_id() != frame_ || !(copy->map() == map_)) return false;
    }
    return true;
  }
  /// Runs until all copies are the owner's map; the time it took, or -1 after `most`.
  std::int64_t settle(std::int64_t most) {
    const std::int64_t begin = air_.now();
    while (!settled()) {
      if (air_.now() - begin > most) return -1;
      run(10'000);
    }
    return air_.now() - begin;
  }

  [[nodiscard]] std::int64_t boot_id() const { return boot_id_; }
  [[nodiscard]] LockstepBus& air() { return air_; }
  [[nodiscard]] const BrickMap& map() const { return map_; }
  [[nodiscard]] BrickSender& sender() { return *sender_; }
  [[nodiscard]] std::vector<std::unique_ptr<Copy>>& copies() { return copies_; }
  [[nodiscard]] std::size_t bytes_sent() const { return earlier_bytes_ + sender_bus_->bytes_sent(); }

 private:
  Link link_;
  double pace_;
  std::uint64_t seed_ = 1;
  LockstepBus air_{1'000'000 * kSecond};
  Counters sender_counters_;
  BrickMap map_;
  std::string frame_;
  std::int64_t boot_id_ = 0;
  std::size_t earlier_bytes_ = 0;
  std::unique_ptr<LossyBus> sender_bus_;
  std::unique_ptr<BrickSender> sender_;
  std::vector<std::unique_ptr<Copy>> copies_;
};

/// A slab of edge * edge bricks.
inline void fill(StreamWorld& world, int edge, std::uint64_t seed = 1) {
  for (int x = 0; x < edge; ++x) {
    for (int y = 0; y < edge; ++y) world.set({x, y, 0}, noisy_brick(++seed));
  }
}

}  // namespace concord::test
