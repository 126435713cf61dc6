#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

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

/// Disjoint, merged intervals of versions, both ends included.
class VersionSet {
 public:
  void add(std::int64_t first, std::int64_t last);
  void remove(std::int64_t first, std::int64_t last);
  void clear() { intervals_.clear(); }

  [[nodiscard]] bool empty() const { return intervals_.empty(); }
  [[nodiscard]] bool contains(std::int64_t first, std::int64_t last) const;
  /// Whether adding this interval would join it to one that is there.
  [[nodiscard]] bool touches(std::int64_t first, std::int64_t last) const;
  [[nodiscard]] std::int64_t highest() const { return empty() ? 0 : intervals_.rbegin()->second; }
  [[nodiscard]] const std::map<std::int64_t, std::int64_t>& intervals() const { return intervals_; }
  /// The parts of [1, last] that are not in the set.
  [[nodiscard]] std::vector<std::pair<std::int64_t, std::int64_t>> missing(std::int64_t last) const;

 private:
  std::map<std::int64_t, std::int64_t> intervals_;  ///< first -> last
};

/// Keeps every receiver's copy of a BrickMap equal to the owner's, at a bounded rate.
/// It holds no brick: it reads them from `map`, which must outlive it and may only change together with `touch`.
class BrickSender {
 public:
  struct Config {
    std::string stream;  ///< e.g. "in/robot1", "out/map"
    double resolution = 0.05;
    double bytes_per_second = 5e6;
    std::int64_t boot_id = 0;      ///< microseconds of this start: greater than any earlier one
    std::int64_t incarnation = 0;  ///< another one: what was removed has come again, and is not what it was
  };

  BrickSender(Bus& bus, Counters& counters, Config config, const BrickMap& map);
  ~BrickSender() = default;
  BrickSender(const BrickSender&) = delete;
  BrickSender& operator=(const BrickSender&) = delete;

  /// A new frame: everything said so far is void. What is in the map now is announced, and sent to who asks for it.
  /// Nothing is sent before the first.
  void begin(const std::string& frame_id);
  /// The owner changed this brick (or emptied it); one that is as it was sent costs nothing. @pre begin was called.
  void touch(BrickIndex index);
  /// The owner stops speaking of this content (agent removed); digests say so until the next `begin`.
  void end();
  /// Sends what the pace allows now instead of at the next timer.
  void send_now();

  [[nodiscard]] std::int64_t boot_id() const { return config_.boot_id; }  ///< of the present epoch
  [[nodiscard]] std::int64_t revision() const { return revision_; }
  [[nodiscard]] std::int64_t bytes_sent() const { return bytes_sent_; }
  /// Everything touched has been sent at least once.
  [[nodiscard]] bool idle() const { return pending_.empty() && repairs_.empty(); }

 private:
  struct Entry {
    std::int64_t version = 0;
    std::uint64_t content = 0;  ///< its share of the digest
    bool gone = true;
  };

  void renew_epoch();
  [[nodiscard]] bool repairs_ready() const;
  void enlist(BrickIndex index, std::uint64_t content, bool gone);
  double send_one();
  double send_packet(std::int64_t first, std::int64_t last);
  void send_digest();
  void on_request(const BrickRequest& request);

  Bus& bus_;
  Counters& counters_;
  Config config_;
  StreamChannels channels_;
  const BrickMap& map_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< owns the timer, the subscription, the turn

  bool begun_ = false;
  std::string frame_id_;
  std::int64_t revision_ = 0;
  std::int64_t brick_count_ = 0;
  std::uint64_t content_ = 0;
  std::unordered_map<BrickIndex, Entry, IndexHash> entries_;
  std::map<std::int64_t, BrickIndex> live_;  ///< by version
  VersionSet pending_;                       ///< never sent
  VersionSet repairs_;                       ///< asked for, gathered until repairs_due_
  std::int64_t repairs_due_ = 0;
  bool repair_next_ = false;
  bool in_pass_ = false;  ///< packets were sent that no digest has followed
  std::int64_t last_digest_ = 0;
  std::int64_t next_digest_ = 0;
  std::int64_t bytes_sent_ = 0;
};

/// The other end. Bricks are handed on as they arrive; each is whole and newest-wins, so any order is right.
class BrickReceiver {
 public:
  struct Config {
    std::string stream;
    double resolution = 0.05;             ///< packets of another one are refused
    std::int64_t max_bricks = 8'000'000;  ///< further ones are refused and counted, and no longer asked for
  };
  struct Events {
    /// A new frame or incarnation (or the first): all bricks of the one before are void.
    std::function<void(const std::string& frame_id)> on_frame;
    /// A brick is now this; empty: gone. Called only when the content differs.
    std::function<void(BrickIndex, Brick)> on_brick;
    /// The sender said that the stream has ended.
    std::function<void()> on_end;
  };

  /// Asks for repairs on its own; the messages come through on_packet and on_digest, from a subscription that the
  /// owner has (one regex may serve many agents).
  BrickReceiver(Bus& bus, Counters& counters, Config config, Events events);
  ~BrickReceiver() = default;
  BrickReceiver(const BrickReceiver&) = delete;
  BrickReceiver& operator=(const BrickReceiver&) = delete;

  void on_packet(const BrickPacket& packet);
  void on_digest(const BrickDigest& digest);

  /// All versions up to the last announced revision have arrived; false until a digest announced one.
  [[nodiscard]] bool synced() const;
  [[nodiscard]] bool heard() const { return boot_id_ != 0; }
  [[nodiscard]] const std::string& frame_id() const { return frame_id_; }
  [[nodiscard]] std::int64_t incarnation() const { return incarnation_; }
  [[nodiscard]] std::int64_t revision() const { return std::max(announced_, covered_.highest()); }
  /// All versions up to this one have arrived: what is held knows of everything that the sender had changed by then.
  [[nodiscard]] std::int64_t whole_revision() const;
  /// Versions announced but not received.
  [[nodiscard]] std::int64_t missing() const;

  /// Takes what is already known of this frame, e.g. read back from disk: a digest that matches is in sync at once.
  void adopt(const std::string& frame_id, const BrickMap& map);
  /// Refuses everything more of the present frame; another frame begins anew.
  void close_frame();

 private:
  struct Held {
    std::int64_t version = 0;  ///< 0: from before this epoch
    std::uint64_t content = 0;
    bool gone = true;
  };
  struct Arrived {
    BrickIndex index;
    std::int64_t version;
    Brick brick;
  };

  /// Who says it: what packets and digests have in common.
  struct Origin {
    std::int64_t boot_id;
    std::int64_t incarnation;
    const std::string& frame_id;
    double resolution;
  };

  bool enter(const Origin& origin);
  [[nodiscard]] bool has_room(const BrickPacket& packet, const std::vector<Arrived>& bricks) const;
  void cut_at(std::int64_t revision);
  [[nodiscard]] Result<std::vector<Arrived>> unpack(const BrickPacket& packet) const;
  void hold(Arrived arrived);
  void cover(std::int64_t first, std::int64_t last);
  void forget_held();
  void doubt_held();
  void drop_unconfirmed();
  void compare(const BrickDigest& digest);
  void request_missing();

  Bus& bus_;
  Counters& counters_;
  Config config_;
  StreamChannels channels_;
  Events events_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< owns the timer

  std::int64_t boot_id_ = 0;
  std::int64_t incarnation_ = 0;
  std::string frame_id_;
  std::optional<std::string> closed_frame_;
  std::int64_t announced_ = 0;  ///< by the last digest
  VersionSet covered_;
  std::unordered_map<BrickIndex, Held, IndexHash> held_;
  std::int64_t brick_count_ = 0;
  std::uint64_t content_ = 0;
  bool unconfirmed_ = false;   ///< some held bricks are from an earlier epoch
  bool digest_heard_ = false;  ///< in this epoch: before it nobody knows how much there is
  bool full_ = false;          ///< the stream has more than is kept here
  std::int64_t last_heard_ = 0;
  std::int64_t last_progress_ = 0;
  std::int64_t asked_up_to_ = 0;
  std::int64_t ask_at_ = 0;
  std::uint64_t random_;
};

}  // namespace concord
