#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/counters.hpp"
#include "bus/messages.hpp"

namespace concord {

/// One list stream on three channels: `<name>` (parts), `<name>/digest` and `<name>/need`. For lists of a few hundred
/// things that change together: the protocol is in stream.md.
struct ListChannels {
  explicit ListChannels(const std::string& list) : parts(list), digest(list + "/digest"), need(list + "/need") {}
  std::string parts, digest, need;
};

/// What a list may hold. Parts and items beyond it are refused.
template <class T>
inline constexpr std::size_t kMostItems = 0;
template <>
inline constexpr std::size_t kMostItems<Zone> = kMaxZones;
template <>
inline constexpr std::size_t kMostItems<Lease> = kMaxLeases;

/// Keeps every receiver's copy of a list equal to the owner's, at the pace that all streams of the bus share.
/// Defined for Zone and Lease.
template <class T>
class ListSender {
 public:
  ListSender(Bus& bus, Counters& counters, const std::string& list, double bytes_per_second);
  ListSender(const ListSender&) = delete;
  ListSender& operator=(const ListSender&) = delete;

  /// The list from now on, in an order that depends on nothing else; says so if it is not as it was. Nothing is said
  /// before the first. @pre at most kMostItems<T>.
  void set(const std::vector<T>& items);

 private:
  using Part = std::vector<T>;

  void on_request(const ListRequest& request);
  void send_now();
  double send_one();
  void send_digest();

  Bus& bus_;
  Counters& counters_;
  ListChannels channels_;
  double bytes_per_second_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< owns the timer and the subscriptions

  bool begun_ = false;
  std::uint64_t content_ = 0;
  std::vector<Part> parts_;
  std::size_t next_part_ = 0;    ///< of the pass that is being sent
  std::int64_t repeat_due_ = 0;  ///< a pass was asked for; 0: none
  std::int64_t next_digest_ = 0;
};

/// The other end: subscribes, asks for what is missing, and hands on whole lists only. Until a new list is there whole,
/// the one before stays.
template <class T>
class ListReceiver {
 public:
  /// Called with each list that differs from the one before, and with the first.
  using OnChange = std::function<void(const std::vector<T>& items)>;

  ListReceiver(Bus& bus, Counters& counters, const std::string& list, OnChange on_change);
  ListReceiver(const ListReceiver&) = delete;
  ListReceiver& operator=(const ListReceiver&) = delete;

  /// The list is what the last digest announced; false until one did.
  [[nodiscard]] bool synced() const { return wanted_ && held_content_ == wanted_->content; }
  /// As it was last handed on; empty before the first.
  [[nodiscard]] const std::vector<T>& items() const { return items_; }

 private:
  void on_part(ListPart<T> part);
  void on_digest(const ListDigest& digest);
  void begin_anew();
  void take_if_whole();
  void ask_if_quiet();
  [[nodiscard]] std::int64_t back_off();

  Bus& bus_;
  Counters& counters_;
  ListChannels channels_;
  OnChange on_change_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< owns the timer and the subscriptions

  std::optional<std::uint64_t> held_content_;
  std::vector<T> items_;

  std::optional<ListDigest> wanted_;             ///< the last
  std::map<std::int32_t, ListPart<T>> arrived_;  ///< parts of the list that is wanted
  std::size_t items_arrived_ = 0;
  std::int64_t ask_at_ = 0;
  std::int64_t wait_ = 0;  ///< until it asks again; longer each time
  std::uint64_t random_;
};

}  // namespace concord
