#include "bus/list_stream.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cassert>

#include "bus/messages_asset.hpp"
#include "bus/messages_detection.hpp"
#include "bus/messages_label.hpp"
#include "bus/pack.hpp"

namespace concord {
namespace {

constexpr std::int64_t kSendStep = 5'000;
constexpr std::int64_t kAskStep = 10'000;
constexpr std::int64_t kDigestPeriod = 1'000'000;
constexpr std::int64_t kGatherRequests = 80'000;
constexpr std::int64_t kQuiet = 150'000;  ///< nothing came for so long: what was to come is lost
constexpr std::int64_t kLongestWait = 1'200'000;
constexpr std::int64_t kMostBackOff = 30'000;
/// What the wire adds to a part's items, for the pace.
constexpr double kOverheadBytes = 100;

/// An item as it stands in a part's message: behind what one without items is.
template <class T>
Bytes on_the_wire(const T& item) {
  Bytes bytes = encode(ListPart<T>{0, 0, 1, {item}, {}}, 0);
  const std::size_t before = encode(ListPart<T>{}, 0).size();
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(before));
  return bytes;
}

/// Of the items' bytes, one part after the other: the same however they are divided.
class ContentHash {
 public:
  ContentHash() : state_(XXH3_createState()) { XXH3_64bits_reset(state_); }
  ~ContentHash() { XXH3_freeState(state_); }
  ContentHash(const ContentHash&) = delete;
  ContentHash& operator=(const ContentHash&) = delete;

  void add(const Bytes& bytes) { XXH3_64bits_update(state_, bytes.data(), bytes.size()); }
  [[nodiscard]] std::uint64_t value() const { return XXH3_64bits_digest(state_); }

 private:
  XXH3_state_t* state_;
};

}  // namespace

template <class T>
ListSender<T>::ListSender(Bus& bus, Counters& counters, const std::string& list, double bytes_per_second)
    : bus_(bus), counters_(counters), channels_(list), bytes_per_second_(bytes_per_second) {
  listen<ListRequest>(
      bus_, counters_, "", channels_.need,
      [this](const std::string&, const ListRequest& request) { on_request(request); }, alive_);
  bus_.pace().join(alive_, [this] { return send_one(); });
  bus_.every(
      kSendStep, [this] { send_now(); }, alive_);
}

template <class T>
void ListSender<T>::set(const std::vector<T>& items) {
  assert(items.size() <= kMostItems<T>);
  ContentHash hash;
  std::vector<Part> parts = pack(items, [&](const T& item) {
    const Bytes bytes = on_the_wire(item);
    hash.add(bytes);
    return bytes.size();
  });
  if (begun_ && hash.value() == content_) return;
  begun_ = true;
  content_ = hash.value();
  parts_ = std::move(parts);
  next_part_ = 0;
  repeat_due_ = 0;
  send_digest();
}

template <class T>
void ListSender<T>::on_request(const ListRequest& request) {
  if (begun_ && request.content == content_ && repeat_due_ == 0) repeat_due_ = bus_.now() + kGatherRequests;
}

template <class T>
void ListSender<T>::send_now() {
  if (!begun_) return;
  const std::int64_t time = bus_.now();
  if (time >= next_digest_) send_digest();
  // Who asks during a pass asks for what went before: the next pass has it.
  if (repeat_due_ != 0 && time >= repeat_due_ && next_part_ == parts_.size()) {
    repeat_due_ = 0;
    next_part_ = 0;
  }
  bus_.pace().serve(time, bytes_per_second_);
}

/// Returns what it costs.
template <class T>
double ListSender<T>::send_one() {
  if (next_part_ == parts_.size()) return 0;
  const ListPart<T> part{content_,
                         static_cast<std::int32_t>(next_part_),
                         static_cast<std::int32_t>(parts_.size()),
                         parts_[next_part_],
                         {}};
  ++next_part_;
  const Bytes bytes = encode(part, bus_.now());
  bus_.publish(channels_.parts, bytes);
  return static_cast<double>(bytes.size()) + kOverheadBytes;
}

template <class T>
void ListSender<T>::send_digest() {
  next_digest_ = bus_.now() + kDigestPeriod;
  bus_.publish(channels_.digest, encode(ListDigest{content_, static_cast<std::int32_t>(parts_.size())}, bus_.now()));
}

template <class T>
ListReceiver<T>::ListReceiver(Bus& bus, Counters& counters, const std::string& list, OnChange on_change)
    : bus_(bus),
      counters_(counters),
      channels_(list),
      on_change_(std::move(on_change)),
      random_(static_cast<std::uint64_t>(bus.now()) ^ XXH3_64bits(list.data(), list.size())) {
  listen<ListPart<T>>(
      bus_, counters_, "", channels_.parts, [this](const std::string&, ListPart<T> part) { on_part(std::move(part)); },
      alive_);
  listen<ListDigest>(
      bus_, counters_, "", channels_.digest,
      [this](const std::string&, const ListDigest& digest) { on_digest(digest); }, alive_);
  bus_.every(
      kAskStep, [this] { ask_if_quiet(); }, alive_);
}

template <class T>
void ListReceiver<T>::on_digest(const ListDigest& digest) {
  if (static_cast<std::size_t>(digest.parts) > kMostItems<T>) {
    return counters_.refused(channels_.digest, {Code::kTooLarge, "the list has more parts than items are kept"});
  }
  const bool same = wanted_ && wanted_->content == digest.content && wanted_->parts == digest.parts;
  if (same) return;
  wanted_ = digest;
  begin_anew();
  take_if_whole();  // one without items is
}

template <class T>
void ListReceiver<T>::begin_anew() {
  arrived_.clear();
  items_arrived_ = 0;
  wait_ = kQuiet;
  ask_at_ = bus_.now() + wait_ + back_off();
}

template <class T>
void ListReceiver<T>::on_part(ListPart<T> part) {
  if (synced() || !wanted_ || part.content != wanted_->content || part.parts != wanted_->parts) return;
  if (arrived_.contains(part.part)) return;
  if (items_arrived_ + part.items.size() > kMostItems<T>) {
    return counters_.refused(channels_.parts, {Code::kTooLarge, "the list has more items than are kept"});
  }
  items_arrived_ += part.items.size();
  const std::int32_t number = part.part;
  arrived_.emplace(number, std::move(part));
  wait_ = kQuiet;
  ask_at_ = bus_.now() + wait_ + back_off();
  take_if_whole();
}

template <class T>
void ListReceiver<T>::take_if_whole() {
  if (synced() || arrived_.size() != static_cast<std::size_t>(wanted_->parts)) return;
  ContentHash hash;
  std::vector<T> items;
  items.reserve(items_arrived_);
  for (auto& [number, part] : arrived_) {
    hash.add(part.encoded);
    std::ranges::move(part.items, std::back_inserter(items));
  }
  begin_anew();
  if (hash.value() != wanted_->content) {
    return counters_.refused(channels_.parts, {Code::kMalformed, "the list is not what its digest says"});
  }
  held_content_ = hash.value();
  items_ = std::move(items);
  on_change_(items_);
}

template <class T>
void ListReceiver<T>::ask_if_quiet() {
  if (!wanted_ || synced() || bus_.now() < ask_at_) return;
  bus_.publish(channels_.need, encode(ListRequest{wanted_->content}, bus_.now()));
  wait_ = std::min(2 * wait_, kLongestWait);
  ask_at_ = bus_.now() + wait_ + back_off();
}

/// Many that miss the same thing do not ask at once.
template <class T>
std::int64_t ListReceiver<T>::back_off() {
  random_ = random_ * 6364136223846793005ULL + 1442695040888963407ULL;
  return static_cast<std::int64_t>((random_ >> 33) % kMostBackOff);
}

template class ListSender<Zone>;
template class ListSender<Lease>;
template class ListSender<LabelSlot>;
template class ListSender<Asset>;
template class ListSender<Thing>;
template class ListReceiver<Zone>;
template class ListReceiver<Lease>;
template class ListReceiver<LabelSlot>;
template class ListReceiver<Asset>;
template class ListReceiver<Thing>;

}  // namespace concord
