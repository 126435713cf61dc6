#include "cli/stream_gaps.hpp"

#include <algorithm>

namespace concord {
namespace {

constexpr std::int64_t kMostClouds = std::int64_t{1} << 60;  // sums do not overflow

/// X of "X/bricks".
std::string before_last_slash(const std::string& channel) { return channel.substr(0, channel.rfind('/')); }

/// What an unsynced stream lacks.
StreamGaps::Gap gap_in(const std::string& channel, const BrickReceiver& receiver) {
  if (!receiver.heard()) {
    return {channel, std::nullopt, "nothing of it can be taken: it has another resolution than the site"};
  }
  if (const std::int64_t missing = receiver.missing(); missing > 0) {
    return {channel, missing, "versions were announced and never recorded"};
  }
  return {channel, std::nullopt, "no digest of it was recorded, so nobody knows whether it is whole"};
}

}  // namespace

BrickReceiver& StreamGaps::receiver(const std::string& stream) {
  std::unique_ptr<BrickReceiver>& slot = streams_[stream];
  if (!slot) {
    slot =
        std::make_unique<BrickReceiver>(bus_, counters_, BrickReceiver::Config{stream, resolution_},
                                        BrickReceiver::Events{[](const std::string&) {}, [](BrickIndex, Brick) {}, {}});
  }
  return *slot;
}

void StreamGaps::hear(std::int64_t utime, const std::string& channel, std::span<const std::uint8_t> bytes) {
  bus_.advance_to(utime);
  if (channel.ends_with("/bricks")) {
    const auto packet = decode<BrickPacket>(bytes);
    if (!packet) return unreadable(channel);
    receiver(before_last_slash(channel)).on_packet(*packet);
  } else if (channel.ends_with("/digest")) {
    const auto digest = decode<BrickDigest>(bytes);
    if (!digest) return unreadable(channel);
    receiver(before_last_slash(channel)).on_digest(*digest);
  } else if (channel.ends_with("/cloud")) {
    const auto cloud = decode<CloudMessage>(bytes);
    if (!cloud || cloud->sequence >= kMostClouds) return unreadable(channel);
    Clouds& clouds = clouds_[channel];
    clouds.frame_id = cloud->frame_id;
    clouds.heard[cloud->frame_id][cloud->boot_id].add(cloud->sequence + 1, cloud->sequence + 1);
  } else if (channel.ends_with("/octomap")) {
    if (!decode<OctomapMessage>(bytes)) unreadable(channel);
  }
}

std::vector<StreamGaps::Gap> StreamGaps::gaps() const {
  std::vector<Gap> gaps;
  for (const auto& [channel, count] : unreadable_) {
    gaps.push_back({channel, count, "messages cannot be read: damaged, or of another release"});
  }
  for (const auto& [stream, receiver] : streams_) {
    if (!receiver->synced()) gaps.push_back(gap_in(stream + "/bricks", *receiver));
  }
  for (const auto& [channel, clouds] : clouds_) {
    std::int64_t count = 0;
    for (const auto& [boot_id, heard] : clouds.heard.at(clouds.frame_id)) {
      for (const auto& [first, last] : heard.missing(heard.highest())) count += last - first + 1;
    }
    if (count > 0) gaps.push_back({channel, count, "clouds were sent and never recorded"});
  }
  std::ranges::stable_sort(gaps, {}, &Gap::channel);
  return gaps;
}

}  // namespace concord
