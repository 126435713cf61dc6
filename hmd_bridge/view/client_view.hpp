#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <unordered_map>
#include <vector>

#include "view/block_store.hpp"
#include "view/view_region.hpp"

namespace concord::hmd {

/// What one client has of one layer, and what it still lacks. It keeps no frames: what is sent is made from the newest
/// state at the moment when it can be sent.
class ClientView {
 public:
  ClientView(const BlockStore& store, ViewRegion region);
  /// Of a client that came back: it has every block of `region` as of `revision`.
  ClientView(const BlockStore& store, ViewRegion region, std::int64_t revision);

  void look(const BlockStore& store, ViewRegion region);
  /// The block is another than before.
  void changed(const BlockStore& store, const BlockKey& key);
  /// The layer began anew; the client has been told to drop all it has.
  void restart();

  struct Due {
    BlockKey key;
    std::int64_t since;  ///< what the client has of it; 0: nothing
  };
  /// The nearest block that is lacking, nothing if none is.
  [[nodiscard]] std::optional<Due> nearest() const;
  /// The client will have the block as it is now.
  void sent(const BlockStore& store, const BlockKey& key);
  /// Blocks that the client has and should drop, of one level; nothing while it is better to send first.
  [[nodiscard]] std::vector<BlockKey> take_forgotten();

  [[nodiscard]] const ViewRegion& region() const { return region_; }
  [[nodiscard]] std::size_t lacking() const { return lacking_.size(); }
  [[nodiscard]] std::size_t in_view() const { return seen_; }
  [[nodiscard]] bool complete() const { return lacking_.empty() && forgotten_.empty(); }
  /// States that were replaced before they could be sent.
  [[nodiscard]] std::int64_t skipped() const { return skipped_; }
  /// What the client has of a block; 0: nothing.
  [[nodiscard]] std::int64_t held(const BlockKey& key) const;

 private:
  void want(const BlockKey& key);

  ViewRegion region_;
  std::unordered_map<BlockKey, std::int64_t, BlockKeyHash> held_;
  std::set<std::pair<double, BlockKey>> lacking_;
  std::vector<BlockKey> forgotten_;
  std::size_t seen_ = 0;
  std::int64_t skipped_ = 0;
};

}  // namespace concord::hmd
