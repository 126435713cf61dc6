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
/// What may be sent in one go after a pause: well inside a default socket buffer.
constexpr double kBurstBytes = 100'000;
/// What the wire adds to a packet's data, for the pace.
constexpr double kOverheadBytes = 160;

}  // namespace

BrickSender::BrickSender(Bus& bus, Counters& counters, Config config, const BrickMap& map)
    : bus_(bus),
      counters_(counters),
      config_(std::move(config)),
      channels_(config_.stream),
      map_(map),
      last_step_(bus.now()) {
  bus_.subscribe(channels_.need, [this, alive = std::weak_ptr(alive_)](const std::string& channel, auto bytes) {
    if (alive.expired()) return;
    const auto request = decode<BrickRequest>(bytes);
    if (request) return on_request(*request);
    counters_.refused(channel, request.error().error);
  });
  bus_.every(kStep, [this, alive = std::weak_ptr(alive_)] {
    if (!alive.expired()) send_now();
  });
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
  for (const BrickIndex index : map_.sorted_bricks()) touch(index);
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
  Entry& entry = known != entries_.end() ? known->second : entries_[index];
  if (entry.version != 0) live_.erase(entry.version);
  content_ -= entry.content;
  brick_count_ -= entry.gone ? 0 : 1;
  entry = {++revision_, content, gone};
  content_ += entry.content;
  brick_count_ += entry.gone ? 0 : 1;
  live_.emplace_hint(live_.end(), entry.version, index);
  pending_.add(entry.version, entry.version);
}

void BrickSender::on_request(const BrickRequest& request) {
  if (!begun_ || request.boot_id != config_.boot_id) return;
  if (repairs_.empty()) repairs_due_ = bus_.now() + kGatherRepairs;
  for (const auto& [first, last] : request.intervals) {
    if (first <= revision_) repairs_.add(first, std::min(last, revision_));
  }
}

void BrickSender::send_now() {
  const std::int64_t time = bus_.now();
  const double earned =
      config_.bytes_per_second * static_cast<double>(std::max<std::int64_t>(0, time - last_step_)) * 1e-6;
  budget_ = std::min(budget_ + earned, kBurstBytes);
  last_step_ = time;
  if (!begun_) return;
  if (time >= next_digest_) send_digest();
  const bool had_work = !pending_.empty() || repairs_ready();
  while (budget_ > 0 && (!pending_.empty() || repairs_ready())) {
    // In turns: a late joiner who asks for everything must not hold up what is new, nor what is new the joiner.
    const bool repair = pending_.empty() || (repair_next_ && repairs_ready());
    repair_next_ = !repair;
    const auto [first, last] = *(repair ? repairs_ : pending_).intervals().begin();
    send_packet(first, last);
  }
  if (!had_work || !pending_.empty() || repairs_ready()) return;
  next_digest_ = std::min(next_digest_, last_digest_ + kDigestAfterPass);
  if (time >= next_digest_) send_digest();
}

bool BrickSender::repairs_ready() const { return !repairs_.empty() && bus_.now() >= repairs_due_; }

void BrickSender::send_packet(std::int64_t first, std::int64_t last) {
  BrickPacket packet{bus_.now(), config_.boot_id, frame_id_, config_.resolution, first, last, 0, {}};
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
  budget_ -= static_cast<double>(packet.data.size()) + kOverheadBytes;
  bytes_sent_ += static_cast<std::int64_t>(bytes.size());
  bus_.publish(channels_.bricks, bytes);
}

void BrickSender::send_digest() {
  const Bytes bytes = encode(
      BrickDigest{bus_.now(), config_.boot_id, frame_id_, config_.resolution, revision_, brick_count_, content_});
  last_digest_ = bus_.now();
  next_digest_ = last_digest_ + kDigestPeriod;
  bytes_sent_ += static_cast<std::int64_t>(bytes.size());
  bus_.publish(channels_.digest, bytes);
}

}  // namespace concord
