#pragma once

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/lockstep_bus.hpp"
#include "merge/merge_node.hpp"
#include "semantic/semantic_node.hpp"

namespace concord {

/// A semantic node beside a real merge node, an agent's stream as ingest sends it, and somebody who hears the labels.
class SemanticStation : public ::testing::Test {
 protected:
  SemanticStation() {
    std::string pattern = (std::filesystem::temp_directory_path() / "concord-semantic-XXXXXX").string();
    site_.state = ::mkdtemp(pattern.data());
    site_.resolution = 0.1;
    VoxelMask mask{};
    mask[0] = 0xFFFF;
    agent_map_.set({0, 0, 0}, Brick::uniform(mask, kOccupied));
    start();
  }
  ~SemanticStation() override {
    stop();
    std::filesystem::remove_all(site_.state);
  }

  void stop() {
    listener_.reset();
    slots_.reset();
    agent_stream_.reset();
    semantic_.reset();
    merge_.reset();
  }
  /// Everything begins anew but the state folder and the time: as after a kill.
  void start() {
    const std::int64_t time = bus_ ? bus_->now() + 1'000'000 : 1'000'000'000;
    stop();
    bus_ = std::make_unique<LockstepBus>(time);
    heard_.clear();
    bus_->every(1'000'000, [this] {
      bus_->publish("out/status/ingest", encode(ProcessStatus{bus_->now(), "ingest", 1, {}}));
      const std::map<std::string, std::int64_t> said{{"edit_revision", counters_.get("edit_revision")}};
      bus_->publish("out/status/merge", encode(ProcessStatus{bus_->now(), "merge", 1, said}));
      bus_->publish("out/status/semantic", encode(ProcessStatus{bus_->now(), "semantic", 1, {}}));
    });
    merge_ = std::make_unique<MergeNode>(NodeContext{*bus_, counters_, site_, "merge", time});
    semantic_ =
        std::make_unique<SemanticNode>(NodeContext{*bus_, counters_, site_, "semantic", time}, std::launch::deferred);
    bus_->subscribe("out/answer", [this](const std::string&, auto bytes) {
      const Answer answer = *decode<Answer>(bytes);
      if (!answer.id.starts_with("semantic-")) answers_.push_back(answer);  // its own questions to merge
    });
    bus_->subscribe("out/label_list",
                    [this](const std::string&, auto bytes) { lists_.push_back(*decode<LabelList>(bytes)); });
    BrickReceiver::Events events;
    events.on_frame = [this](const std::string&) { heard_.clear(); };
    events.on_brick = [this](BrickIndex index, Brick brick) { heard_.set(index, std::move(brick)); };
    listener_ = std::make_unique<BrickReceiver>(*bus_, counters_, BrickReceiver::Config{"out/labels", site_.resolution},
                                                events);
    bus_->subscribe("out/labels/bricks",
                    [this](const std::string&, auto bytes) { listener_->on_packet(*decode<BrickPacket>(bytes)); });
    bus_->subscribe("out/labels/digest",
                    [this](const std::string&, auto bytes) { listener_->on_digest(*decode<BrickDigest>(bytes)); });
    slots_ = std::make_unique<ListReceiver<LabelSlot>>(*bus_, counters_, "out/label_slots", [](const auto&) {});
    agent_stream_ = std::make_unique<BrickSender>(
        *bus_, counters_, BrickSender::Config{"out/agent/robot1", site_.resolution, 5e6, time, 1}, agent_map_);
    agent_stream_->begin("frame1");
    run(5'000'000);
    if (!placed_) {
      EXPECT_TRUE(
          ask("in/transform", encode(TransformRequest{"t1", "eva", "robot1", "", Transform::Identity()}, bus_->now()))
              .ok);
      placed_ = true;
    }
    run();
  }

  void run(std::int64_t microseconds = 3'000'000) { bus_->advance_to(bus_->now() + microseconds); }

  Answer ask(const std::string& channel, const Bytes& bytes) {
    answers_.clear();
    lists_.clear();
    bus_->publish(channel, bytes);
    bus_->deliver();
    if (answers_.empty()) run(200'000);
    return answers_.empty() ? Answer{} : answers_.back();
  }
  [[nodiscard]] LabelRequest request(const std::string& id, LabelRequest::Op op) const {
    LabelRequest out;
    out.id = id;
    out.author = "eva";
    out.op = op;
    out.utime = bus_->now();
    return out;
  }
  /// Voxels (first, 0, 0) to (last, 0, 0).
  Answer label(const std::string& id, const std::string& name, std::int32_t first, std::int32_t last) {
    LabelRequest out = request(id, LabelRequest::Op::kLabel);
    out.name = name;
    out.shape = VoxelList{site_.resolution, {{{first, 0, 0}, {last, 0, 0}}}};
    return ask("in/label", encode(out));
  }
  Answer change(const std::string& id, LabelRequest::Op op, InstanceId of, const std::string& name = "") {
    LabelRequest out = request(id, op);
    out.of = of;
    out.name = name;
    return ask("in/label", encode(out));
  }
  Answer undo(const std::string& id, const std::string& correction, bool redo = false) {
    LabelRequest out = request(id, redo ? LabelRequest::Op::kRedo : LabelRequest::Op::kUndo);
    out.correction_id = correction;
    return ask("in/label", encode(out));
  }
  /// Who listens to the streams sees this at (x, 0, 0).
  [[nodiscard]] std::string seen(std::int32_t x) const {
    const LogOdds value = heard_.at({x, 0, 0});
    if (!is_known(value)) return "";
    const auto slot = std::ranges::find(slots_->items(), slot_of_value(value), &LabelSlot::slot);
    return slot == slots_->items().end() ? "?" : slot->name + " " + std::to_string(slot->of.instance);
  }

  Site site_;
  Counters counters_;
  std::unique_ptr<LockstepBus> bus_;
  std::unique_ptr<MergeNode> merge_;
  std::unique_ptr<SemanticNode> semantic_;
  BrickMap agent_map_;
  std::unique_ptr<BrickSender> agent_stream_;
  std::unique_ptr<BrickReceiver> listener_;
  BrickMap heard_;
  std::unique_ptr<ListReceiver<LabelSlot>> slots_;
  std::vector<Answer> answers_;
  std::vector<LabelList> lists_;
  bool placed_ = false;
};

}  // namespace concord
