#include <algorithm>
#include <cassert>

#include "bus/brick_stream.hpp"
#include "core/brick_codec.hpp"

namespace concord {
namespace {

constexpr std::size_t kPacketBytes = 1200;
constexpr std::int64_t kStep = 5'000;
constexpr std::int64_t kDigestPeriod = 1'000'000;
/// A pass ends with a digest, but a trickle of changes is not doubled by digests.
constexpr std::int64_t kDigestAfterPass = 50'000;
constexpr std::int64_t kGatherRepairs = 80'000;
/// Bricks that are gone keep a version, so that receivers learn of it; beyond this many more than there are bricks,
/// a new epoch forgets them.
constexpr std::int64_t kMostGone = 4096;
constexpr std::size_t kMaxRepairs = 4096;  ///< intervals
/// What the wire adds to a packet's data, for the pace.
constexpr double kOverheadBytes = 160;

}  // namespace

BrickSender::BrickSender(Bus& bus, Counters& counters, Config config, const BrickMap& map)
    : bus_(bus), counters_(counters), config_(std::move(config)), channels_(config_.stream), map_(map) {
  const auto hear = [this](const std::string& channel, std::span<const std::uint8_t> bytes) {
    const auto request = decode<BrickRequest>(bytes);
    if (request) return on_request(*request);
    counters_.refused(channel, request.error().error);
  };
  bus_.subscribe(channels_.need, hear, Bus::kQueued, alive_);
  bus_.pace().join(alive_, [this] { return send_one(); });
  bus_.every(
      kStep, [this] { send_now(); }, alive_);
}

void BrickSender::renew_epoch() {
  if (begun_) ++config_.boot_id;
  begun_ = true;
  revision_ = 0;
  brick_count_ = 0;
  content_ = 0;
  entries_.clear();
  live_.clear();
  pending_.clear();
  repairs_.clear();
  next_digest_ = 0;
}

void BrickSender::begin(const std::string& frame_id) {
  assert(is_name(frame_id));
  renew_epoch();
  frame_id_ = frame_id;
  // Receivers that have all this already are in sync with the first digest; others ask for what they miss.
  for (const BrickIndex index : map_.sorted_bricks()) enlist(index, content_hash(index, *map_.find(index)), false);
}

void BrickSender::end() {
  renew_epoch();
  frame_id_.clear();
}

void BrickSender::touch(BrickIndex index) {
  assert(begun_ && !frame_id_.empty());
  const Brick* brick = map_.find(index);
  const bool gone = brick == nullptr;
  const std::uint64_t content = gone ? 0 : content_hash(index, *brick);
  const auto known = entries_.find(index);
  if (known == entries_.end() ? gone : known->second.gone == gone && known->second.content == content) return;
  enlist(index, content, gone);
  pending_.add(revision_, revision_);
  const auto gone_bricks = static_cast<std::int64_t>(entries_.size()) - brick_count_;
  if (gone_bricks > brick_count_ + kMostGone) begin(std::string(frame_id_));
}

void BrickSender::enlist(BrickIndex index, std::uint64_t content, bool gone) {
  Entry& entry = entries_[index];
  if (entry.version != 0) live_.erase(entry.version);
  content_ -= entry.content;
  brick_count_ -= entry.gone ? 0 : 1;
  entry = {++revision_, content, gone};
  content_ += entry.content;
  brick_count_ += entry.gone ? 0 : 1;
  live_.emplace_hint(live_.end(), entry.version, index);
}

void BrickSender::on_request(const BrickRequest& request) {
  if (!begun_ || request.boot_id != config_.boot_id) return;
  if (repairs_.empty()) repairs_due_ = bus_.now() + kGatherRepairs;
  for (const auto& [first, last] : request.intervals) {
    if (repairs_.intervals().size() >= kMaxRepairs) return;  // it will ask again
    if (first <= revision_) repairs_.add(first, std::min(last, revision_));
  }
}

void BrickSender::send_now() {
  if (!begun_) return;
  const std::int64_t time = bus_.now();
  if (time >= next_digest_) send_digest();
  bus_.pace().serve(time, config_.bytes_per_second);
  if (!in_pass_ || !pending_.empty() || repairs_ready()) return;
  in_pass_ = false;
  next_digest_ = std::min(next_digest_, last_digest_ + kDigestAfterPass);
  if (time >= next_digest_) send_digest();
}

double BrickSender::send_one() {
  if (!begun_ || (pending_.empty() && !repairs_ready())) return 0;
  in_pass_ = true;
  // In turns: a late joiner who asks for everything must not hold up what is new, nor what is new the joiner.
  const bool repair = pending_.empty() || (repair_next_ && repairs_ready());
  repair_next_ = !repair;
  const auto [first, last] = *(repair ? repairs_ : pending_).intervals().begin();
  return send_packet(first, last);
}

bool BrickSender::repairs_ready() const { return !repairs_.empty() && bus_.now() >= repairs_due_; }

/// Returns what it costs.
double BrickSender::send_packet(std::int64_t first, std::int64_t last) {
  BrickPacket packet{bus_.now(), config_.boot_id,    frame_id_, config_.resolution, first, last, 0,
                     {},         config_.incarnation};
  BrickIndex before{};
  Bytes one;
  for (auto it = live_.lower_bound(first); it != live_.end() && it->first <= last; ++it) {
    const auto& [version, index] = *it;
    const Brick* brick = map_.find(index);
    one.clear();
    append_varint(one, static_cast<std::uint64_t>(version - first));
    append_varint(one, zigzag(index.x - before.x));
    append_varint(one, zigzag(index.y - before.y));
    append_varint(one, zigzag(index.z - before.z));
    append_brick(one, brick != nullptr ? *brick : Brick{});
    if (packet.count > 0 && packet.data.size() + one.size() > kPacketBytes) {
      packet.last_version = version - 1;
      break;
    }
    packet.data.insert(packet.data.end(), one.begin(), one.end());
    ++packet.count;
    before = index;
  }
  pending_.remove(packet.first_version, packet.last_version);
  repairs_.remove(packet.first_version, packet.last_version);
  const Bytes bytes = encode(packet);
  bytes_sent_ += static_cast<std::int64_t>(bytes.size());
  bus_.publish(channels_.bricks, bytes);
  return static_cast<double>(packet.data.size()) + kOverheadBytes;
}

void BrickSender::send_digest() {
  const Bytes bytes = encode(BrickDigest{bus_.now(), config_.boot_id, frame_id_, config_.resolution, revision_,
                                         brick_count_, content_, config_.incarnation});
  last_digest_ = bus_.now();
  next_digest_ = last_digest_ + kDigestPeriod;
  bytes_sent_ += static_cast<std::int64_t>(bytes.size());
  bus_.publish(channels_.digest, bytes);
}

}  // namespace concord
