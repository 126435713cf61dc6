#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>

#include "bus/bus.hpp"
#include "bus/counters.hpp"
#include "bus/messages.hpp"
#include "core/brick_map.hpp"

namespace concord {

/// One brick stream on three channels: `<name>/bricks`, `<name>/digest` and `out/need/<name>`.
/// The protocol is in stream.md; sender and receiver below are its only implementation.
struct StreamChannels {
  explicit StreamChannels(const std::string& stream)
      : bricks(stream + "/bricks"), digest(stream + "/digest"), need("out/need/" + stream) {}
  std::string bricks, digest, need;
};

/// Keeps every receiver's copy of a BrickMap equal to the owner's, at a bounded rate.
/// It holds no brick: it reads them from `map`, which must outlive it and may only change together with `touch`.
class BrickSender {
 public:
  struct Config {
    std::string stream;  ///< e.g. "in/robot1", "out/map"
    double resolution = 0.05;
    double bytes_per_second = 5e6;
    std::int64_t boot_id = 0;  ///< must differ from that of every earlier start
  };

  BrickSender(Bus& bus, Counters& counters, Config config, const BrickMap& map);

  /// A new frame: everything sent so far is void. Called once before the first touch.
  void begin(const std::string& frame_id);
  /// The owner changed this brick (or emptied it).
  void touch(BrickIndex index);
  /// The owner stops speaking of this stream altogether (agent removed).
  void end();

  [[nodiscard]] std::int64_t revision() const { return revision_; }
  [[nodiscard]] std::int64_t bytes_sent() const { return bytes_sent_; }
  /// Everything touched has been sent at least once.
  [[nodiscard]] bool idle() const { return pending_.empty(); }

 private:
  struct Entry {
    std::int64_t version = 0;
    std::uint64_t content = 0;  ///< its share of the digest; 0 when the brick is gone
  };

  void step();
  void send_interval(std::int64_t first, std::int64_t last);
  void send_digest();
  void on_request(const BrickRequest& request);

  Bus& bus_;
  Counters& counters_;
  Config config_;
  StreamChannels channels_;
  const BrickMap& map_;

  std::string frame_id_;
  std::int64_t revision_ = 0;
  std::int64_t brick_count_ = 0;
  std::uint64_t content_ = 0;
  std::unordered_map<BrickIndex, Entry, IndexHash> entries_;
  std::map<std::int64_t, BrickIndex> by_version_;
  std::map<std::int64_t, std::int64_t> pending_;  ///< disjoint intervals of versions to send, first -> last
  std::int64_t repairs_due_ = 0;                  ///< requests are gathered until then
  std::map<std::int64_t, std::int64_t> repairs_;
  double budget_ = 0;  ///< bytes that may be sent now
  std::int64_t last_step_ = 0;
  std::int64_t next_digest_ = 0;
  std::int64_t bytes_sent_ = 0;
};

/// The other end. Bricks are handed on as they arrive; each is whole and newest-wins, so any order is right.
class BrickReceiver {
 public:
  struct Config {
    std::string stream;
    double resolution = 0.05;               ///< packets of another one are refused
    std::int64_t max_bricks = 4'000'000;    ///< beyond it packets are refused and counted
    std::uint64_t seed = 1;                 ///< of the request back-off
    bool may_request = true;                ///< false: only listen (a log reader)
  };
  struct Events {
    /// A new frame (or the first): all bricks of the one before are void.
    std::function<void(const std::string& frame_id)> on_frame;
    /// A brick is now this; empty: gone.
    std::function<void(BrickIndex, Brick)> on_brick;
  };

  BrickReceiver(Bus& bus, Counters& counters, Config config, Events events);

  /// Feeds a message from a channel whose subscription the caller owns (one regex for all agents).
  void on_packet(const BrickPacket& packet);
  void on_digest(const BrickDigest& digest);

  /// All versions up to the last announced revision have arrived.
  [[nodiscard]] bool synced() const;
  [[nodiscard]] bool heard() const { return boot_id_.has_value(); }
  [[nodiscard]] const std::string& frame_id() const { return frame_id_; }
  [[nodiscard]] std::int64_t revision() const { return announced_; }
  /// Versions announced but not received.
  [[nodiscard]] std::int64_t missing() const;

  /// Takes what is already known of this frame, e.g. read back from disk: a digest that matches is in sync at once.
  void adopt(const std::string& frame_id, const BrickMap& map);
  /// Refuses everything more of the present frame; the next frame begins anew.
  void close_frame();

 private:
  struct Held {
    std::int64_t version = 0;
    std::uint64_t content = 0;
    bool confirmed = false;  ///< seen under the present boot
  };

  bool enter(std::int64_t boot_id, const std::string& frame_id, double resolution);
  void cover(std::int64_t first, std::int64_t last);
  void hold(BrickIndex index, std::int64_t version, Brick brick);
  void finish_boot();
  void step();
  void request_missing();

  Bus& bus_;
  Counters& counters_;
  Config config_;
  StreamChannels channels_;
  Events events_;

  std::optional<std::int64_t> boot_id_;
  std::string frame_id_;
  std::int64_t announced_ = 0;
  std::map<std::int64_t, std::int64_t> covered_;  ///< disjoint, merged intervals
  std::unordered_map<BrickIndex, Held, IndexHash> held_;
  std::int64_t brick_count_ = 0;
  std::uint64_t content_ = 0;
  bool unconfirmed_ = false;  ///< some held bricks are from an earlier boot
  bool closed_ = false;
  std::int64_t last_heard_ = 0;
  std::int64_t next_request_ = 0;
  int rounds_ = 0;
  std::uint64_t random_;
};

}  // namespace concord
