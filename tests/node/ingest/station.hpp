#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/lockstep_bus.hpp"
#include "core/octomap_writer.hpp"
#include "ingest/ingest_node.hpp"

namespace concord::testing {

inline constexpr std::int64_t kSecond = 1'000'000;
inline constexpr std::int64_t kBegin = 1'700'000'000 * kSecond;

/// What someone who hears the streams `out/agent/AGENT` holds of each agent.
class Follower {
 public:
  struct Copy {
    std::unique_ptr<BrickReceiver> receiver;
    std::string frame_id;
    BrickMap map;
    int frames = 0;
    int ends = 0;
  };

  Follower(Bus& bus, Counters& counters, double resolution) : bus_(bus), counters_(counters), resolution_(resolution) {
    listen<BrickPacket>(bus, counters, "follower", "out/agent/[^/]+/bricks",
                        [this](const std::string& channel, const BrickPacket& packet) {
                          copy_of(channel).receiver->on_packet(packet);
                        });
    listen<BrickDigest>(bus, counters, "follower", "out/agent/[^/]+/digest",
                        [this](const std::string& channel, const BrickDigest& digest) {
                          copy_of(channel).receiver->on_digest(digest);
                        });
  }

  [[nodiscard]] const Copy& operator[](const std::string& id) { return copies_[id]; }

 private:
  Copy& copy_of(const std::string& channel) {
    const std::string id = channel.substr(10, channel.rfind('/') - 10);
    Copy& copy = copies_[id];
    if (copy.receiver != nullptr) return copy;
    BrickReceiver::Events events;
    events.on_frame = [&copy](const std::string& frame_id) {
      copy.frame_id = frame_id;
      copy.map.clear();
      ++copy.frames;
    };
    events.on_brick = [&copy](BrickIndex index, Brick brick) { copy.map.set(index, std::move(brick)); };
    events.on_end = [&copy] {
      copy.frame_id.clear();
      copy.map.clear();
      ++copy.ends;
    };
    copy.receiver = std::make_unique<BrickReceiver>(
        bus_, counters_, BrickReceiver::Config{"out/agent/" + id, resolution_}, std::move(events));
    return copy;
  }

  Bus& bus_;
  Counters& counters_;
  double resolution_;
  std::map<std::string, Copy> copies_;
};

/// One start of ingest, with what robots and people see of it.
struct Start {
  Start(const Site& site, std::int64_t begin)
      : bus(begin), follower(bus, counters, site.resolution), node({bus, counters, site, "ingest", begin}) {
    listen<Answer>(bus, counters, "test", "out/answer",
                   [this](const std::string&, const Answer& value) { answers[value.id].push_back(value); });
    listen<Downsampled>(bus, counters, "test", "out/downsampled",
                        [this](const std::string&, const Downsampled& value) { parts.push_back(value); });
    bus.subscribe("out/need/in/.*", [this](const std::string&, auto) { ++requests; });
  }

  void run(double seconds) {
    bus.advance_to(bus.now() + static_cast<std::int64_t>(seconds * kSecond));
    bus.deliver();
  }
  template <class Value>
  void say(const std::string& channel, const Value& value) {
    bus.publish(channel, encode(value));
    bus.deliver();
  }
  template <class Value>
  void say_at(const std::string& channel, const Value& value) {
    bus.publish(channel, encode(value, bus.now()));
    bus.deliver();
  }
  template <class Request>
  Answer ask(const std::string& channel, const Request& request) {
    const std::size_t before = answers[request.id].size();
    bus.publish(channel, encode(request, bus.now()));
    run(0.5);
    EXPECT_EQ(answers[request.id].size(), before + 1) << "answers to " << request.id;
    return answers[request.id].empty() ? Answer{} : answers[request.id].back();
  }
  Answer ask(const AgentRequest& request) { return ask("in/agent_request", request); }
  Answer ask(const MapRequest& request) { return ask("in/map_request", request); }
  Answer ask(const DownsampleRequest& request) { return ask("in/downsample", request); }

  LockstepBus bus;
  Counters counters;
  Follower follower;
  std::map<std::string, std::vector<Answer>> answers;
  std::vector<Downsampled> parts;
  int requests = 0;
  IngestNode node;  ///< the first to go
};

/// A state folder that ingest is started on, again and again.
class IngestStation : public ::testing::Test {
 protected:
  IngestStation() {
    std::string pattern = (std::filesystem::temp_directory_path() / "concord-ingest-XXXXXX").string();
    site_.state = ::mkdtemp(pattern.data());
    site_.resolution = 0.1;
    restart();
  }
  ~IngestStation() override {
    start_.reset();
    std::filesystem::remove_all(site_.state);
  }

  void restart() {
    start_.reset();
    begin_ += 1000 * kSecond;
    start_.emplace(site_, begin_);
  }

  void say_octomap(const std::string& id, const std::string& frame_id, const BrickMap& map) {
    const auto data = write_octomap_data(map, OctomapFormat::kFull).value();
    start_->say("in/" + id + "/octomap", OctomapMessage{start_->bus.now(), frame_id, site_.resolution, false, data});
    start_->run(0.5);
  }

  /// `bricks` bricks that all differ.
  static BrickMap some_map(int bricks, int seed = 0) {
    BrickMap map;
    for (int i = 0; i < bricks; ++i) {
      DenseBrick dense;
      dense.fill(kUnknown);
      for (int v = 0; v < 90; ++v) {
        dense[static_cast<std::size_t>((v * 37 + i * 5 + seed) % kBrickVoxels)] =
            static_cast<LogOdds>((v * 131 + i * 7 + seed) % 3000 - 1200);
      }
      map.set({i % 20 - 10, i / 20, seed % 3}, Brick::from_dense(dense));
    }
    return map;
  }

  Site site_;
  std::int64_t begin_ = kBegin;
  std::optional<Start> start_;
};

/// A robot that sends its submap as a brick stream.
class Robot {
 public:
  Robot(Start& start, const std::string& id, const std::string& frame_id, const BrickMap& map, double resolution)
      : map_(map), sender_(start.bus, start.counters, {"in/" + id, resolution, 5e6, start.bus.now()}, map_) {
    sender_.begin(frame_id);
  }
  void set(BrickIndex index, Brick brick) {
    map_.set(index, std::move(brick));
    sender_.touch(index);
  }
  void begin(const std::string& frame_id) { sender_.begin(frame_id); }
  [[nodiscard]] const BrickMap& map() const { return map_; }

 private:
  BrickMap map_;
  BrickSender sender_;
};

}  // namespace concord::testing
