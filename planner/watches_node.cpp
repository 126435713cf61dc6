#include "planner/watches_node.hpp"

#include <cmath>

namespace concord {
namespace {

/// The path as it lies in a frame. What is said of heights stays the map's.
Path in_frame(Path path, const Transform& T_map_frame) {
  const Transform T_frame_map = T_map_frame.inverse();
  for (Eigen::Vector3d& p : path.points) p = T_frame_map * p;
  for (PathPoint& point : path.details) {
    const Eigen::Vector3d way = T_frame_map.linear() * Eigen::Vector3d(std::cos(point.yaw), std::sin(point.yaw), 0);
    point.yaw = std::atan2(way.y(), way.x());
  }
  if (path.nearest) {
    path.nearest = (T_frame_map * Eigen::Vector3d(path.nearest->x(), path.nearest->y(), path.zmin)).head<2>().eval();
  }
  return path;
}

}  // namespace

std::set<std::string> WatchesNode::set_agents(const AgentList& list) {
  std::map<std::string, Placed> now;
  for (const AgentState& agent : list.agents) {
    if (agent.aligned) now[agent.id] = {agent.frame_id, agent.T_map_agent};
  }
  std::set<std::string> moved;
  for (const auto& [agent, placed] : now) {
    const auto before = placed_.find(agent);
    const bool is_same = before != placed_.end() && before->second.frame_id == placed.frame_id &&
                         before->second.T_map_agent.matrix() == placed.T_map_agent.matrix();
    if (!is_same) moved.insert(agent);
  }
  placed_ = std::move(now);
  return moved;
}

Result<void> WatchesNode::watch(const PathWatch& watch) {
  const std::int64_t now = context_.bus.now();
  std::erase_if(watches_, [&](const auto& entry) { return entry.second < now; });
  if (!placed_.contains(watch.frame_agent)) {
    return refuse(Code::kNotAligned, watch.frame_agent + " is not aligned: its frame has no place in the map");
  }
  const std::pair key(watch.frame_agent, watch.robot);
  if (watches_.size() >= kMaxWatches && !watches_.contains(key)) {
    return refuse(Code::kBusy, "so many programs watch paths already: ask again later");
  }
  watches_[key] = now + kHolds;
  return {};
}

void WatchesNode::say(const Path& path, const std::string& agent) {
  const std::int64_t now = context_.bus.now();
  std::set<std::string> frames;
  for (const auto& [key, until] : watches_) {
    const bool is_meant = key.second.empty() || key.second == path.robot;
    if (is_meant && until >= now && (agent.empty() || key.first == agent)) frames.insert(key.first);
  }
  for (const std::string& frame : frames) {
    const auto placed = placed_.find(frame);
    if (placed == placed_.end()) continue;
    Path there = in_frame(path, placed->second.T_map_agent);
    there.frame_agent = frame;
    there.frame_id = placed->second.frame_id;
    context_.bus.publish("out/path_in/" + frame, encode(there));
  }
}

}  // namespace concord
