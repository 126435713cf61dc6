#include <algorithm>
#include <cassert>
#include <cmath>

#include <xxhash.h>

#include "bus/brick_stream.hpp"
#include "core/brick_codec.hpp"
#include "core/decimal.hpp"

namespace concord {
namespace {

constexpr std::int64_t kStep = 10'000;
constexpr std::int64_t kQuiet = 150'000;  ///< nothing came for so long: what was to come is lost
constexpr std::int64_t kMaxBackOff = 30'000;
constexpr std::int64_t kBootSilence = 3'000'000;
constexpr std::size_t kMaxIntervalsHeld = 65'536;
constexpr std::size_t kMaxIntervalsAsked = 64;  ///< in one request: one frame on the wire
constexpr std::size_t kMaxRequests = 16;        ///< in one go

std::uint64_t next_random(std::uint64_t& state) {
  state += 0x9E3779B97F4A7C15ULL;
  std::uint64_t z = (state ^ (state >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

}  // namespace

BrickReceiver::BrickReceiver(Bus& bus, Counters& counters, Config config, Events events)
    : bus_(bus),
      counters_(counters),
      config_(std::move(config)),
      channels_(config_.stream),
      events_(std::move(events)),
      random_(static_cast<std::uint64_t>(bus.now()) ^ XXH3_64bits(config_.stream.data(), config_.stream.size())) {
  bus_.every(
      kStep, [this] { request_missing(); }, alive_);
}

bool BrickReceiver::synced() const {
  return digest_heard_ && !unconfirmed_ && (announced_ == 0 || covered_.contains(1, announced_));
}

std::int64_t BrickReceiver::whole_revision() const {
  const auto first = covered_.intervals().begin();
  return first != covered_.intervals().end() && first->first <= 1 ? first->second : 0;
}

std::int64_t BrickReceiver::missing() const {
  std::int64_t sum = 0;
  for (const auto& [first, last] : covered_.missing(announced_)) sum += last - first + 1;
  return sum;
}

void BrickReceiver::adopt(const std::string& frame_id, const BrickMap& map) {
  assert(!heard() && held_.empty());
  frame_id_ = frame_id;
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    const std::uint64_t content = content_hash(index, brick);
    held_[index] = {0, content, false};
    content_ += content;
    ++brick_count_;
  });
  unconfirmed_ = brick_count_ > 0;
}

void BrickReceiver::close_frame() {
  closed_frame_ = frame_id_;
  forget_held();
}

void BrickReceiver::forget_held() {
  held_.clear();
  content_ = 0;
  brick_count_ = 0;
  unconfirmed_ = false;
}

/// Whether what is said under this epoch and frame counts; moves on to a newer epoch.
bool BrickReceiver::enter(const Origin& origin) {
  const auto& [boot_id, incarnation, frame_id, resolution] = origin;
  const std::int64_t time = bus_.now();
  if (!(std::abs(resolution - config_.resolution) <= 1e-9)) {
    counters_.refused(config_.stream, {Code::kBadResolution, "stream has " + decimal(resolution) + " m, the site " +
                                                                 decimal(config_.resolution) + " m"});
    return false;
  }
  if (boot_id == boot_id_) {
    if (frame_id != frame_id_ || incarnation != incarnation_) {
      counters_.refused(config_.stream, {Code::kBadFrame, "frame changed without a new epoch"});
      return false;
    }
    last_heard_ = time;
    return frame_id != closed_frame_;
  }
  if (boot_id < boot_id_ && time - last_heard_ < kBootSilence) {
    counters_.refused(config_.stream,
                      {Code::kStale, "a sender that started before the one that is heard now (boot_id " +
                                         std::to_string(boot_id) + ", not " + std::to_string(boot_id_) +
                                         ") still speaks; if two have this id, end one or give it another"});
    return false;
  }
  boot_id_ = boot_id;
  last_heard_ = time;
  announced_ = 0;
  digest_heard_ = false;
  asked_up_to_ = 0;
  ask_at_ = 0;
  covered_.clear();
  full_ = false;
  const bool same = frame_id == frame_id_ && incarnation == incarnation_ && !frame_id.empty();
  frame_id_ = frame_id;
  incarnation_ = incarnation;
  if (same) {
    doubt_held();
  } else {
    forget_held();
  }
  if (frame_id == closed_frame_) return false;
  if (same) return true;
  if (!frame_id.empty()) {
    events_.on_frame(frame_id);
  } else if (events_.on_end) {
    events_.on_end();
  }
  return true;
}

/// What is held may no longer be so: the versions it came with say nothing any more.
void BrickReceiver::doubt_held() {
  covered_.clear();
  std::erase_if(held_, [](const auto& entry) { return entry.second.gone; });
  for (auto& [index, held] : held_) held.version = 0;
  unconfirmed_ = !held_.empty();
}

Result<std::vector<BrickReceiver::Arrived>> BrickReceiver::unpack(const BrickPacket& packet) const {
  std::vector<Arrived> bricks;
  ByteSpan rest = packet.data;
  const auto malformed = [] { return refuse(Code::kMalformed, "a brick packet does not hold the bricks it counts"); };
  std::int64_t x = 0, y = 0, z = 0;
  for (std::int32_t i = 0; i < packet.count; ++i) {
    const auto offset = read_varint(rest);
    const auto dx = read_varint(rest), dy = read_varint(rest), dz = read_varint(rest);
    if (!offset || !dx || !dy || !dz) return malformed();
    if (*offset > static_cast<std::uint64_t>(packet.last_version - packet.first_version)) return malformed();
    const auto moved = [](std::int64_t from, std::uint64_t by) {  // unsigned: hostile sums must not overflow
      return static_cast<std::int64_t>(static_cast<std::uint64_t>(from) + static_cast<std::uint64_t>(unzigzag(by)));
    };
    x = moved(x, *dx);
    y = moved(y, *dy);
    z = moved(z, *dz);
    const auto small = [](std::int64_t c) { return std::abs(static_cast<double>(c)) < kMaxVoxel; };
    if (!small(x) || !small(y) || !small(z)) return refuse(Code::kOutOfBounds, "a brick lies beyond the map's bounds");
    const BrickIndex index{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), static_cast<std::int32_t>(z)};
    if (!in_bounds(index)) return refuse(Code::kOutOfBounds, "a brick lies beyond the map's bounds");
    auto brick = read_brick(rest);
    if (!brick) return tl::unexpected(brick.error());
    bricks.push_back({index, packet.first_version + static_cast<std::int64_t>(*offset), std::move(*brick)});
  }
  if (!rest.empty()) return malformed();
  return bricks;
}

void BrickReceiver::on_packet(const BrickPacket& packet) {
  const bool present = packet.boot_id == boot_id_ && packet.frame_id == frame_id_;
  if (present && covered_.contains(packet.first_version, packet.last_version)) {
    // Heard before; and if it was long under way, what it holds may have been replaced since.
    last_heard_ = bus_.now();
    return;
  }
  auto bricks = unpack(packet);
  if (!bricks) return counters_.refused(channels_.bricks, bricks.error());
  if (!enter({packet.boot_id, packet.incarnation, packet.frame_id, packet.resolution})) return;
  if (!has_room(packet, *bricks)) {
    full_ = true;
    return counters_.refused(channels_.bricks, {Code::kTooLarge, "stream has more bricks or holes than are kept"});
  }
  for (Arrived& arrived : *bricks) hold(std::move(arrived));
  cover(packet.first_version, packet.last_version);
}

bool BrickReceiver::has_room(const BrickPacket& packet, const std::vector<Arrived>& bricks) const {
  if (covered_.intervals().size() >= kMaxIntervalsHeld &&
      !covered_.touches(packet.first_version, packet.last_version)) {
    return false;
  }
  const auto added = std::ranges::count_if(bricks, [&](const Arrived& a) { return !held_.contains(a.index); });
  return static_cast<std::int64_t>(held_.size()) + added <= config_.max_bricks;
}

void BrickReceiver::hold(Arrived arrived) {
  Held& held = held_[arrived.index];
  if (arrived.version <= held.version) return;
  const bool gone = arrived.brick.empty();
  const std::uint64_t content = gone ? 0 : content_hash(arrived.index, arrived.brick);
  const bool changed = gone != held.gone || content != held.content;
  content_ += content - held.content;
  brick_count_ += (gone ? 0 : 1) - (held.gone ? 0 : 1);
  held = {arrived.version, content, gone};
  if (changed) events_.on_brick(arrived.index, std::move(arrived.brick));
}

void BrickReceiver::cover(std::int64_t first, std::int64_t last) {
  if (first <= asked_up_to_ && !covered_.contains(first, last)) last_progress_ = bus_.now();
  covered_.add(first, last);
}

/// All that the present epoch has was sent again: what it did not speak of is no longer there.
void BrickReceiver::drop_unconfirmed() {
  unconfirmed_ = false;
  std::vector<BrickIndex> dropped;
  for (const auto& [index, held] : held_) {
    if (held.version == 0) dropped.push_back(index);
  }
  std::sort(dropped.begin(), dropped.end());
  for (const BrickIndex index : dropped) {
    const auto it = held_.find(index);
    const Held held = it->second;
    held_.erase(it);
    if (held.gone) continue;
    content_ -= held.content;
    --brick_count_;
    events_.on_brick(index, Brick{});
  }
}

void BrickReceiver::on_digest(const BrickDigest& digest) {
  if (!enter({digest.boot_id, digest.incarnation, digest.frame_id, digest.resolution})) return;
  digest_heard_ = true;
  announced_ = digest.revision;
  if (covered_.highest() > announced_) return cut_at(announced_);
  compare(digest);
}

/// The digest is the authority: what packets said of versions beyond it (they overtook it, or were not the sender's)
/// must be said again. The next digest compares.
void BrickReceiver::cut_at(std::int64_t revision) {
  covered_.remove(revision + 1, covered_.highest());
  for (auto& [index, held] : held_) {
    if (held.version > revision) held.version = 0;
  }
}

void BrickReceiver::compare(const BrickDigest& digest) {
  const auto equal = [&] { return digest.brick_count == brick_count_ && digest.content == content_; };
  if (unconfirmed_ && equal()) {
    // The sender began anew with what is held here: nothing needs to be sent.
    unconfirmed_ = false;
    if (digest.revision > 0) covered_.add(1, digest.revision);
    return;
  }
  if (digest.revision > 0 && !covered_.contains(1, digest.revision)) return;
  // Only a digest may end the doubt: before it, a packet's reach is not the sender's.
  if (unconfirmed_) drop_unconfirmed();
  if (equal()) return;
  counters_.add("stream_mismatch." + config_.stream);
  doubt_held();
}

void BrickReceiver::request_missing() {
  if (!heard() || full_ || frame_id_ == closed_frame_ || revision() == 0) return;
  if (covered_.contains(1, revision())) {
    ask_at_ = 0;
    return;
  }
  const std::int64_t time = bus_.now();
  const bool awaiting = asked_up_to_ > 0 && time - last_progress_ < kQuiet;
  if (awaiting) return;
  auto holes = covered_.missing(revision());
  const bool quiet = time - last_heard_ > kQuiet;
  if (!quiet && holes.back().second == announced_) holes.pop_back();  // the tail may still be on its way
  if (holes.empty()) return;
  if (ask_at_ == 0) {
    ask_at_ = time + static_cast<std::int64_t>(next_random(random_) % kMaxBackOff);
    return;
  }
  if (time < ask_at_) return;
  if (holes.size() > kMaxIntervalsAsked * kMaxRequests) holes.resize(kMaxIntervalsAsked * kMaxRequests);
  asked_up_to_ = holes.back().second;
  last_progress_ = time;
  ask_at_ = 0;
  for (std::size_t i = 0; i < holes.size(); i += kMaxIntervalsAsked) {
    const auto end = holes.begin() + static_cast<std::ptrdiff_t>(std::min(i + kMaxIntervalsAsked, holes.size()));
    counters_.add("requests." + config_.stream);
    bus_.publish(channels_.need,
                 encode(BrickRequest{boot_id_, {holes.begin() + static_cast<std::ptrdiff_t>(i), end}}, time));
  }
}

}  // namespace concord
