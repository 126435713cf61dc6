#include "agent/sim/sim_node.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>

#include <spdlog/spdlog.h>

#include "core/scan.hpp"

namespace concord {
namespace {

constexpr std::int64_t kStep = 5'000;
constexpr std::int64_t kPublishPeriod = 500'000;
constexpr std::int64_t kDrive = 100'000;     // between two poses of a robot that follows a path
constexpr double kBumper = 0.5;              // metres above the floor
constexpr std::int64_t kLinger = 3'000'000;  // a digest a second: time for every receiver to ask for what it lacks

}  // namespace

SimNode::SimNode(const NodeContext& context, const Config& config)
    : bus_(context.bus),
      counters_(context.counters),
      config_(config),
      resolution_(context.site.resolution),
      boot_id_(context.boot_id),
      world_(make_warehouse(config.seed)),
      robot_(context.site.agent(config.agent)) {
  if (config.kind == AgentKind::kCamera) {
    cloud_out_.emplace(bus_, counters_, config.agent, boot_id_, [this] { begin(); });
  } else {
    const SubmapPublisher::Config stream{config.agent, resolution_, context.site.stream.bytes_per_second, boot_id_};
    submap_out_.emplace(bus_, counters_, stream, [this] { begin(); });
  }
  begin();
  bus_.every(kStep, [this] { step(); });
  bus_.every(kPublishPeriod, [this] { publish_changes(); });
  if (config.kind == AgentKind::kHeadset) return;  // a person goes where they like
  listen<Path>(bus_, counters_, context.process, "out/path/" + config.agent,
               [this](const std::string&, const Path& path) {
                 if (follower_) follower_->hear(path, bus_.now());
               });
  bus_.every(kDrive, [this] { drive(); });
}

/// A robot has a bumper: what stands there stops it, be it seen or not.
void SimNode::drive() {
  if (self_->next_time() <= self_->duration()) return;
  if (!follower_) {
    const Transform T = self_->last_pose();
    follower_.emplace(PathFollower::Place{T.translation().head<2>(), std::atan2(T.linear()(1, 0), T.linear()(0, 0))},
                      robot_.speed);
  }
  const Eigen::Vector2d from = follower_->place().p;
  const double yaw = follower_->heading();
  const Ray ahead{{from.x(), from.y(), kBumper}, {std::cos(yaw), std::sin(yaw), 0}};
  const double reach = robot_.radius + robot_.speed * kDrive * 1e-6;
  const auto hit = world_.cast(ahead, reach, Glass::kStops);
  const bool moved = follower_->go(kDrive * 1e-6, hit ? hit->distance - robot_.radius : reach, bus_.now());
  if (hit) counters_.add("bumps");
  counters_.set("driven_cm", std::llround(100 * follower_->driven()));
  counters_.set("stops", follower_->stops());
  if (!moved) return;
  Transform T_map_base = Transform::Identity();
  T_map_base.translation().head<2>() = follower_->place().p;
  T_map_base.linear() = Eigen::AngleAxisd(follower_->place().yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Transform T_agent_base = self_->go_on(T_map_base);
  submap_out_ ? submap_out_->publish_pose(T_agent_base, bus_.now())
              : cloud_out_->publish_pose(T_agent_base, bus_.now());
}

void SimNode::begin() {
  const std::uint64_t own = config_.seed * 1000 + static_cast<std::uint64_t>(config_.kind) * 100;
  self_.emplace(world_, config_.kind, own + static_cast<std::uint64_t>(frames_));
  ++frames_;
  const std::string frame_id = std::to_string(boot_id_) + "-" + std::to_string(frames_);
  if (submap_out_) submap_out_->begin_frame(frame_id);
  if (cloud_out_) cloud_out_->begin_frame(frame_id);
  began_ = bus_.now();
  scans_ = 0;
  follower_.reset();
  submap_.clear();
  changed_.clear();
  idle_since_ = 0;
  const Transform T_map_agent = start_pose(config_.kind);
  const Eigen::Quaterniond q(T_map_agent.linear());
  const Eigen::Vector3d& p = T_map_agent.translation();
  spdlog::info("frame {} begins; true T_map_agent {} {} {}  {} {} {} {}", frame_id, p.x(), p.y(), p.z(), q.x(), q.y(),
               q.z(), q.w());
}

void SimNode::step() {
  // One moment a step, so that messages are heard in between however far it has fallen behind.
  const double simulated = static_cast<double>(bus_.now() - began_) * 1e-6 * config_.speed;
  if (self_->next_time() <= simulated) {
    if (const std::optional<Moment> moment = self_->next()) take(*moment);
  }
  report();
  if (config_.leave) leave_when_all_is_sent();
}

void SimNode::take(const Moment& moment) {
  ++scans_;
  const std::int64_t utime = bus_.now();
  if (submap_out_) {
    map(moment);
    submap_out_->publish_pose(moment.T_agent_base, utime);
  } else {
    cloud_out_->publish(moment.T_agent_sensor, self_->sensor().trusted_range, moment.points, utime);
    cloud_out_->publish_pose(moment.T_agent_base, utime);
  }
}

void SimNode::map(const Moment& moment) {
  Result<CheckedScan> scan =
      checked({moment.T_agent_sensor, self_->sensor().trusted_range, moment.points}, resolution_);
  if (!scan) return counters_.refused("scan", scan.error());
  const Result<std::vector<BrickIndex>> changed = integrate(submap_, resolution_, scan->scan);
  if (!changed) return counters_.refused("scan", changed.error());
  changed_.insert(changed->begin(), changed->end());
}

void SimNode::publish_changes() {
  if (!submap_out_) return;
  for (const BrickIndex index : changed_) {
    const Brick* brick = submap_.find(index);
    submap_out_->publish_brick(index, brick != nullptr ? *brick : Brick());
  }
  changed_.clear();
}

void SimNode::report() {
  const double share = std::min(self_->next_time() / self_->duration(), 1.0);
  counters_.set("progress_percent",
                std::min(static_cast<std::int64_t>(100 * share), std::int64_t{all_sent() ? 100 : 99}));
  counters_.set("scans", scans_);
  counters_.set("frames", frames_);
  counters_.set("bytes_sent", submap_out_ ? submap_out_->bytes_sent() : cloud_out_->bytes_sent());
}

bool SimNode::all_sent() const { return changed_.empty() && (!submap_out_ || submap_out_->idle()); }

void SimNode::leave_when_all_is_sent() {
  if (self_->next_time() <= self_->duration() || !all_sent()) {
    idle_since_ = 0;
  } else if (idle_since_ == 0) {
    idle_since_ = bus_.now();
  } else if (bus_.now() - idle_since_ > kLinger) {
    std::raise(SIGTERM);
  }
}

}  // namespace concord
