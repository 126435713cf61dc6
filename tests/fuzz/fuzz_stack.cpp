#include <filesystem>
#include <memory>

#include <stdlib.h>

#include <spdlog/spdlog.h>

#include "../unit/bus/message_samples.hpp"
#include "bus/lockstep_bus.hpp"
#include "ingest/ingest_node.hpp"
#include "merge/merge_node.hpp"
#include "must.hpp"
#include "planner/planner_node.hpp"
#include "semantic/semantic_node.hpp"

// Not one message but what a stack makes of many: almost good ones, in any order, at any time, on the channels that
// they belong to.

using namespace concord;

namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;

/// Of each type, where somebody hears it.
const char* channel_of(const std::string& type) {
  static const std::map<std::string, const char*> kChannels = {{"brick_packet_t", "in/robot1/bricks"},
                                                               {"brick_digest_t", "in/robot1/digest"},
                                                               {"brick_request_t", "out/need/out/map"},
                                                               {"octomap_t", "in/robot2/octomap"},
                                                               {"cloud_t", "in/robot3/cloud"},
                                                               {"agent_pose_t", "in/robot1/pose"},
                                                               {"frame_over_t", "out/frame_over/robot1"},
                                                               {"map_pose_t", "out/pose/robot1"},
                                                               {"set_transform_t", "in/transform"},
                                                               {"edit_t", "in/edit"},
                                                               {"undo_t", "in/undo"},
                                                               {"zone_request_t", "in/zone"},
                                                               {"lease_request_t", "in/lease"},
                                                               {"weight_request_t", "in/weight"},
                                                               {"localise_request_t", "in/localise"},
                                                               {"history_request_t", "in/history_request"},
                                                               {"history_t", "out/history"},
                                                               {"conflict_request_t", "in/conflict_request"},
                                                               {"conflict_list_t", "out/conflict_list"},
                                                               {"zones_t", "out/zones"},
                                                               {"leases_t", "out/leases"},
                                                               {"list_digest_t", "out/zones/digest"},
                                                               {"list_request_t", "out/zones/need"},
                                                               {"agent_request_t", "in/agent_request"},
                                                               {"downsample_request_t", "in/downsample"},
                                                               {"downsampled_t", "out/downsampled"},
                                                               {"map_request_t", "in/map_request"},
                                                               {"map_list_t", "out/map_list"},
                                                               {"path_request_t", "in/path_request"},
                                                               {"path_watch_t", "in/path_watch"},
                                                               {"path_t", "out/path/robot1"},
                                                               {"answer_t", "out/answer"},
                                                               {"map_edits_t", "out/map_edits"},
                                                               {"agents_t", "out/agents"},
                                                               {"align_request_t", "in/align"},
                                                               {"align_decision_t", "in/align_decision"},
                                                               {"align_result_t", "out/align"},
                                                               {"label_request_t", "in/label"},
                                                               {"label_query_t", "in/label_query"},
                                                               {"label_list_t", "out/label_list"},
                                                               {"label_slots_t", "out/label_slots"},
                                                               {"asset_request_t", "in/asset"},
                                                               {"assets_t", "out/assets"},
                                                               {"detection_t", "in/detection"},
                                                               {"detection_decision_t", "in/detection_decision"},
                                                               {"things_t", "out/things"},
                                                               {"status_t", "out/status/ingest"}};
  return kChannels.at(type);
}

/// The processes on one bus, with their state in memory.
class Stack {
 public:
  Stack() {
    std::string pattern = "/dev/shm/concord-fuzz-XXXXXX";
    fuzz::must(mkdtemp(pattern.data()) != nullptr);
    site_.state = pattern;
    VoxelMask mask{};
    mask[0] = 0xFF;
    submap_.set({0, 0, 0}, Brick::uniform(mask, kOccupied));
    start(kStart);
    hear("in/transform", encode(TransformRequest{"place", "", "robot1", "odom", Transform::Identity()}, bus_->now()));
  }
  ~Stack() {
    running_.reset();
    std::filesystem::remove_all(site_.state);
  }
  Stack(const Stack&) = delete;
  Stack& operator=(const Stack&) = delete;

  void hear(const std::string& channel, const Bytes& bytes) {
    bus_->publish(channel, bytes);
    bus_->deliver();
  }
  void wait(std::int64_t microseconds) { bus_->advance_to(bus_->now() + microseconds); }
  /// Whatever was heard, all can be read again, and nothing that people made is lost.
  void restart() {
    wait(1'000'000);
    const std::int64_t revision = counters_.get("edit_revision"), labels = counters_.get("label_revision");
    start(bus_->now() + 1'000'000);
    fuzz::must(counters_.get("edit_revision") >= revision && counters_.get("label_revision") >= labels);
  }

 private:
  struct Running {
    Running(Bus& bus, Counters& counters, const Site& site, const BrickMap& submap)
        : ingest({bus, counters, site, "ingest", bus.now()}),
          merge({bus, counters, site, "merge", bus.now()}),
          planner({bus, counters, site, "planner", bus.now()}, std::launch::deferred),
          semantic({bus, counters, site, "semantic", bus.now()}, std::launch::deferred),
          robot(bus, counters, {"in/robot1", site.resolution, 5e6, bus.now()}, submap) {
      robot.begin("odom");
    }
    IngestNode ingest;
    MergeNode merge;
    PlannerNode planner;
    SemanticNode semantic;
    BrickSender robot;
  };

  /// Everything but the state folder begins anew.
  void start(std::int64_t time) {
    running_.reset();
    counters_.set("edit_revision", -1);  // until merge says it anew
    bus_ = std::make_unique<LockstepBus>(time);
    running_ = std::make_unique<Running>(*bus_, counters_, site_, submap_);
    wait(1'500'000);
  }

  Site site_;
  Counters counters_;
  BrickMap submap_;
  std::unique_ptr<LockstepBus> bus_;
  std::unique_ptr<Running> running_;
};

/// The input, byte after byte; zeros when it has ended.
struct Input {
  const std::uint8_t* data;
  std::size_t left;
  std::uint8_t byte() {
    if (left == 0) return 0;
    --left;
    return *data++;
  }
  std::size_t number() {
    const std::size_t high = byte();
    return high << 8 | byte();
  }
};

/// A good message with up to seven bytes changed.
Bytes nearly_good(Bytes bytes, Input& input) {
  for (int patches = input.byte() % 8; patches > 0; --patches) {
    const std::size_t at = input.number() % bytes.size();
    bytes[at] = input.byte();
  }
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  spdlog::set_level(spdlog::level::off);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto& samples = test::message_samples();
  Input input{data, size};
  Stack stack;
  // With the sanitizers a restart takes a sixth of a second, and an input has ten.
  for (int steps = 0; steps < 30 && input.left > 0; ++steps) {
    const std::size_t choice = input.byte();
    if (choice == 255) stack.restart();
    if (choice >= 224) {
      stack.wait(static_cast<std::int64_t>(choice - 223) * 100'000);
      continue;
    }
    const test::MessageSample& sample = samples[choice % samples.size()];
    stack.hear(channel_of(sample.type), nearly_good(sample.bytes, input));
  }
  stack.restart();
  return 0;
}
