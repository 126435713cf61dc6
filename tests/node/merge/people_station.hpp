#pragma once

#include <memory>
#include <string>
#include <utility>

#include "merge_station.hpp"

namespace concord {

inline Box box(double low, double high) { return {Eigen::Vector3d::Constant(low), Eigen::Vector3d::Constant(high)}; }

inline Transform at(double x, double y, double yaw = 0) {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(x, y, 0);
  return T;
}

/// A station whose people ask for everything they can.
class PeopleStation : public MergeStation {
 protected:
  Answer zone(const std::string& id, const std::string& author, ZoneRequest::Op op, const std::string& name,
              Volume volume = box(0, 1), WorkFrame frame = {}) {
    return ask("in/zone", encode(ZoneRequest{id, author, op, name, Zone::Kind::kNoGo, volume, frame, -1, bus_->now()}));
  }
  Answer lease(const std::string& id, const std::string& author, bool hold, Volume volume = box(0, 1)) {
    const std::string request_id = "ask-" + std::to_string(++asked_);
    return ask("in/lease", encode(LeaseRequest{request_id, author, id, hold, volume, {}, bus_->now()}));
  }
  Answer weigh(const std::string& id, const std::string& agent, int weight) {
    return ask("in/weight", encode(WeightRequest{id, "eva", agent, weight, bus_->now()}));
  }
  Answer history(const HistoryRequest& request) {
    histories_.clear();
    answers_.clear();
    bus_->publish("in/history_request", encode(request, bus_->now()));
    run(2'000'000);
    return answers_.empty() ? Answer{} : answers_.back();
  }
  Answer ask_conflicts(const std::string& id, int most = 100) {
    conflicts_.clear();
    answers_.clear();
    bus_->publish("in/conflict_request", encode(ConflictRequest{id, most}, bus_->now()));
    run(100'000);
    return answers_.empty() ? Answer{} : answers_.back();
  }
  /// A second agent that has one brick.
  void send_second(LogOdds value, std::uint64_t bits = 0xFF) {
    VoxelMask mask{};
    mask[0] = bits;
    second_map_.set(BrickIndex{2, 0, 0}, Brick::uniform(mask, value));
    if (!second_) {
      second_ = std::make_unique<BrickSender>(
          *bus_, counters_, BrickSender::Config{"out/agent/robot2", site_.resolution, 5e6, bus_->now(), 1},
          second_map_);
      second_->begin("frame1");
    } else {
      second_->touch(BrickIndex{2, 0, 0});
    }
    run();
  }
  Answer place_second(const std::string& id, const Transform& T) {
    return ask("in/transform", encode(TransformRequest{id, "eva", "robot2", "", T}, bus_->now()));
  }
  void restart() {
    second_.reset();
    start();
    run();
  }

  int asked_ = 0;
  BrickMap second_map_;
  std::unique_ptr<BrickSender> second_;
};

}  // namespace concord
