#pragma once

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/list_stream.hpp"
#include "bus/lockstep_bus.hpp"
#include "merge/merge_node.hpp"

namespace concord {

/// A merge node with its surroundings: an agent's stream as ingest sends it, and somebody who hears the map.
class MergeStation : public ::testing::Test {
 protected:
  MergeStation() {
    std::string pattern = (std::filesystem::temp_directory_path() / "concord-merge-XXXXXX").string();
    site_.state = ::mkdtemp(pattern.data());
    site_.resolution = 0.1;
    start();
  }
  ~MergeStation() override { std::filesystem::remove_all(site_.state); }

  /// Everything begins anew but the state folder and the time.
  void start() {
    const std::int64_t time = bus_ ? bus_->now() + 1'000'000 : 1'000'000'000;
    agent_stream_.reset();
    listener_.reset();
    zones_.reset();
    leases_.reset();
    node_.reset();
    bus_ = std::make_unique<LockstepBus>(time);
    heard_.clear();
    answers_.clear();
    bus_->every(1'000'000, [this] {
      if (ingest_is_up_) bus_->publish("out/status/ingest", encode(ProcessStatus{bus_->now(), "ingest", 1, {}}));
    });
    node_ = std::make_unique<MergeNode>(NodeContext{*bus_, counters_, site_, "merge", time});
    listen_as_planner();
    bus_->subscribe("out/answer",
                    [this](const std::string&, auto bytes) { answers_.push_back(*decode<Answer>(bytes)); });
    bus_->subscribe("out/pose/.*",
                    [this](const std::string&, auto bytes) { poses_.push_back(*decode<MapPose>(bytes)); });
    bus_->subscribe("out/agents", [this](const std::string&, auto bytes) { agents_ = *decode<AgentList>(bytes); });
    bus_->subscribe("out/history",
                    [this](const std::string&, auto bytes) { histories_.push_back(*decode<HistoryPart>(bytes)); });
    bus_->subscribe("out/conflict_list",
                    [this](const std::string&, auto bytes) { conflicts_.push_back(*decode<ConflictList>(bytes)); });
    zones_ = std::make_unique<ListReceiver<Zone>>(*bus_, counters_, "out/zones", [](const auto&) {});
    leases_ = std::make_unique<ListReceiver<Lease>>(*bus_, counters_, "out/leases", [](const auto&) {});
    bus_->subscribe("out/map_list", [this](const std::string&, auto bytes) { list_ = *decode<MapList>(bytes); });
    agent_stream_ = std::make_unique<BrickSender>(
        *bus_, counters_, BrickSender::Config{"out/agent/robot1", site_.resolution, 5e6, time, incarnation_},
        agent_map_);
  }

  void listen_as_planner() {
    BrickReceiver::Events events;
    events.on_frame = [this](const std::string&) { heard_.clear(); };
    events.on_brick = [this](BrickIndex index, Brick brick) { heard_.set(index, std::move(brick)); };
    listener_ =
        std::make_unique<BrickReceiver>(*bus_, counters_, BrickReceiver::Config{"out/map", site_.resolution}, events);
    bus_->subscribe("out/map/bricks",
                    [this](const std::string&, auto bytes) { listener_->on_packet(*decode<BrickPacket>(bytes)); });
    bus_->subscribe("out/map/digest",
                    [this](const std::string&, auto bytes) { listener_->on_digest(*decode<BrickDigest>(bytes)); });
  }

  void run(std::int64_t microseconds = 3'000'000) { bus_->advance_to(bus_->now() + microseconds); }

  /// So long that what was refused is looked at anew.
  void let_refusals_pass() { run(RecentAnswers::kRefusalHolds); }

  void send_wall() {
    VoxelMask mask{};
    mask[0] = 0xFF;
    agent_map_.set({2, 0, 0}, Brick::uniform(mask, kOccupied));
    agent_stream_->begin("frame1");
    run(4'000'000);  // ingest's status, and the time after it in which merge hears of all agents
  }

  Answer ask(const std::string& channel, const Bytes& bytes) {
    answers_.clear();
    bus_->publish(channel, bytes);
    bus_->deliver();
    return answers_.empty() ? Answer{} : answers_.back();
  }
  void say_pose(std::int64_t utime, const std::string& frame_id = "frame1") {
    bus_->publish("in/robot1/pose", encode(AgentPose{"", frame_id, Transform::Identity(), utime}));
    bus_->deliver();
  }
  void say_pose() { say_pose(bus_->now()); }
  Answer place(const std::string& id, const Transform& T) {
    return ask("in/transform", encode(TransformRequest{id, "eva", "robot1", "", T}, bus_->now()));
  }
  [[nodiscard]] EditRequest edit_of(const std::string& id, const std::string& author, VoxelIndex voxel) const {
    EditRequest request;
    request.id = id;
    request.author = author;
    request.shape = VoxelList{site_.resolution, {{voxel, voxel}}};
    request.utime = bus_->now();
    return request;
  }
  Answer edit(const EditRequest& request) { return ask("in/edit", encode(request)); }
  Answer add(const std::string& id, VoxelIndex voxel) { return edit(edit_of(id, "eva", voxel)); }
  Answer undo(const std::string& id, const std::string& edit_id, bool redo = false) {
    return ask("in/undo", encode(UndoRequest{id, "eva", edit_id, redo, bus_->now()}));
  }

  Site site_;
  Counters counters_;
  std::unique_ptr<LockstepBus> bus_;
  std::unique_ptr<MergeNode> node_;
  BrickMap agent_map_;
  std::int64_t incarnation_ = 1;
  bool ingest_is_up_ = true;
  std::unique_ptr<BrickSender> agent_stream_;
  std::unique_ptr<BrickReceiver> listener_;
  BrickMap heard_;
  std::vector<Answer> answers_;
  std::vector<MapPose> poses_;
  AgentList agents_;
  MapList list_;
  std::vector<HistoryPart> histories_;
  std::vector<ConflictList> conflicts_;
  std::unique_ptr<ListReceiver<Zone>> zones_;
  std::unique_ptr<ListReceiver<Lease>> leases_;
};

}  // namespace concord
