#pragma once

#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "../../unit/align/rooms.hpp"
#include "align/align_node.hpp"
#include "bus/lockstep_bus.hpp"

namespace concord::test {

/// An align node with its surroundings: agents' streams as ingest sends them, and merge, which places whom it is asked
/// to place.
class AlignStation : public ::testing::Test {
 protected:
  /// What merge does when it is asked to place somebody.
  enum class Merge {
    kPlaces,
    kPlacesAndIsNotHeard,
    kRefuses,
    kIsDown,
  };

  /// A station whose node computes otherwise, or elsewhere, than the real one.
  explicit AlignStation(std::launch how = std::launch::deferred, AlignNode::Compute compute = carry_out)
      : how_(how), compute_(std::move(compute)) {
    std::string pattern = (std::filesystem::temp_directory_path() / "concord-align-XXXXXX").string();
    site_.state = ::mkdtemp(pattern.data());
    site_.resolution = kResolution;
    start();
  }
  ~AlignStation() override {
    node_.reset();
    std::filesystem::remove_all(site_.state);
  }

  /// The node begins anew, with nothing but its state folder; agents and merge go on.
  void start() {
    const std::int64_t time = bus_ ? bus_->now() + 1'000'000 : 1'000'000'000;
    for (auto& [agent, sent] : sent_) sent.sender.reset();
    node_.reset();
    bus_ = std::make_unique<LockstepBus>(time);
    node_ = std::make_unique<AlignNode>(NodeContext{*bus_, counters_, site_, "align", time}, how_, compute_);
    bus_->subscribe("out/answer",
                    [this](const std::string&, auto bytes) { answers_.push_back(*decode<Answer>(bytes)); });
    bus_->subscribe("out/align",
                    [this](const std::string&, auto bytes) { results_.push_back(*decode<AlignResult>(bytes)); });
    bus_->subscribe("in/transform",
                    [this](const std::string&, auto bytes) { place(*decode<TransformRequest>(bytes)); });
    bus_->subscribe("in/undo", [this](const std::string&, auto bytes) { take_back(*decode<UndoRequest>(bytes)); });
    bus_->every(1'000'000, [this] { say_agents(); });
    for (auto& [agent, sent] : sent_) begin_stream(agent, sent);
  }

  /// Sends a submap, as one more agent's or instead of what this one sent.
  void send(const std::string& agent, const Points& points, const std::string& frame_id = "frame1") {
    Sent& sent = sent_[agent];
    sent.sender.reset();
    sent.map = voxels_of(points);
    sent.state = {};
    sent.state.id = agent;
    sent.state.frame_id = frame_id;
    begin_stream(agent, sent);
    run();
  }
  /// It maps on, far off.
  void map_on(const std::string& agent) {
    constexpr BrickIndex kFarOff{100, 0, 0};
    sent_.at(agent).map.set(kFarOff, Brick::uniform(VoxelMask{1}, kOccupied));
    sent_.at(agent).sender->touch(kFarOff);
    run();
  }
  [[nodiscard]] bool lies_in_map(const std::string& agent) const { return sent_.at(agent).state.aligned; }
  void align_by_hand(const std::string& agent, const Transform& T_map_agent) {
    sent_.at(agent).state.aligned = true;
    sent_.at(agent).state.T_map_agent = T_map_agent;
    run();
  }
  /// Somebody is in the map who sends no submap.
  void align_without_submap(const std::string& agent) {
    sent_[agent].state.id = agent;
    align_by_hand(agent, Transform::Identity());
  }
  /// Merge moves it, and says so.
  void set_place(const std::string& agent, const Transform& T_map_agent) {
    sent_.at(agent).state.T_map_agent = T_map_agent;
    say_agents();
  }
  void run(std::int64_t microseconds = 2'000'000) { bus_->advance_to(bus_->now() + microseconds); }

  /// The last answer to this id.
  Answer ask(const std::string& channel, const Bytes& bytes, const std::string& id) {
    answers_.clear();
    bus_->publish(channel, bytes);
    bus_->deliver();
    std::erase_if(answers_, [&](const Answer& answer) { return answer.id != id; });
    return answers_.empty() ? Answer{} : answers_.back();
  }
  Answer request(const AlignRequest& request) { return ask("in/align", encode(request), request.id); }
  /// Asks until there is an answer.
  Answer found(const AlignRequest& wanted) {
    Answer answer = request(wanted);
    for (int i = 0; i < 10 && answer.code == "BUSY"; ++i) {
      run(100'000);
      answer = request(wanted);
    }
    return answer;
  }
  [[nodiscard]] AlignRequest request_of(const std::string& id, const std::string& source,
                                        const std::string& target = "") const {
    return {id, "eva", source, "", target, "", std::nullopt, bus_->now()};
  }
  /// With a rough guess.
  [[nodiscard]] AlignRequest guess_of(const std::string& id, const std::string& source, const std::string& target,
                                      const Transform& T_target_source) const {
    AlignRequest out = request_of(id, source, target);
    out.T_target_source = transform(0.7, -0.4, 0.2, 0.3) * T_target_source;
    return out;
  }
  Answer decide(const std::string& id, AlignDecision::Op op, const std::string& align_id) {
    return ask("in/align_decision", encode(AlignDecision{id, "eva", op, align_id, bus_->now()}), id);
  }
  Answer accept(const std::string& id, const std::string& align_id) {
    return decide(id, AlignDecision::Op::kAccept, align_id);
  }

  Site site_;
  Counters counters_;
  std::unique_ptr<LockstepBus> bus_;
  std::unique_ptr<AlignNode> node_;
  std::vector<Answer> answers_;
  std::vector<AlignResult> results_;
  std::vector<TransformRequest> placements_;
  std::string refused_agent_;  ///< merge places anybody but this one
  Merge merge_ = Merge::kPlaces;

 private:
  struct Sent {
    BrickMap map;
    AgentState state;
    std::unique_ptr<BrickSender> sender;
  };

  void begin_stream(const std::string& agent, Sent& sent) {
    if (sent.state.frame_id.empty()) return;
    sent.sender = std::make_unique<BrickSender>(
        *bus_, counters_, BrickSender::Config{"out/agent/" + agent, kResolution, 5e8, bus_->now(), 1}, sent.map);
    sent.sender->begin(sent.state.frame_id);
  }
  void take_back(const UndoRequest& request) {
    const auto placed =
        std::ranges::find(placements_, request.edit_id, [](const TransformRequest& one) { return one.id; });
    if (placed == placements_.end()) return answer(*bus_, {request.id, "merge", false, "NOT_FOUND", "", 0, 0});
    sent_.at(placed->agent).state.aligned = false;
    answer(*bus_, {request.id, "merge", true, "OK", "undone", 1, 1});
  }
  void place(const TransformRequest& request) {
    placements_.push_back(request);
    if (merge_ == Merge::kIsDown) return;
    if (merge_ == Merge::kRefuses || request.agent == refused_agent_)
      return answer(*bus_, {request.id, "merge", false, "LOCKED", "not now", 0, 0});
    sent_.at(request.agent).state.aligned = true;
    sent_.at(request.agent).state.T_map_agent = request.T_map_agent;
    if (merge_ == Merge::kPlaces) answer(*bus_, {request.id, "merge", true, "OK", "placed", 1, 1});
  }
  void say_agents() {
    AgentList list{bus_->now(), site_.resolution, {}};
    for (const auto& [id, sent] : sent_) list.agents.push_back(sent.state);
    bus_->publish("out/agents", encode(list));
  }

  std::launch how_;
  AlignNode::Compute compute_;
  std::map<std::string, Sent> sent_;
};

}  // namespace concord::test
