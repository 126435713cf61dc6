#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>

namespace concord::hmd {

using SharedText = std::shared_ptr<const std::string>;

/// What waits for one client, beside blocks: texts that must all arrive, in order, and texts of which only the newest
/// of each key matters. One is taken at a time, when the connection can take one.
class Outbox {
 public:
  static constexpr std::size_t kMostBytes = 4 << 20;  ///< of lossless texts
  static constexpr std::size_t kMostTexts = 10'000;

  void lossless(SharedText text);
  /// Takes the place of an older one of this key, which keeps its turn.
  void newest(const std::string& key, SharedText text);
  void forget(const std::string& key);
  /// The next to send, lossless ones first; null if nothing waits.
  [[nodiscard]] SharedText take();

  /// A client that does not take what it must: it is to be disconnected.
  [[nodiscard]] bool overflowed() const { return overflowed_; }
  [[nodiscard]] bool empty() const { return lossless_.empty() && turns_.empty(); }
  [[nodiscard]] std::size_t waiting_bytes() const { return bytes_; }

  /// Credit for binary frames: bytes in all since the beginning; it never shrinks.
  void credit(std::int64_t bytes) { credit_ = bytes > credit_ ? bytes : credit_; }
  [[nodiscard]] bool affords(std::size_t bytes) const { return spent_ + static_cast<std::int64_t>(bytes) <= credit_; }
  void spend(std::size_t bytes) { spent_ += static_cast<std::int64_t>(bytes); }

 private:
  std::deque<SharedText> lossless_;
  std::size_t bytes_ = 0;
  bool overflowed_ = false;
  std::map<std::string, SharedText> newest_;
  std::deque<std::string> turns_;  ///< keys of newest_, those that have waited longest first
  std::int64_t credit_ = 0, spent_ = 0;
};

}  // namespace concord::hmd
