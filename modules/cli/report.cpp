#include "cli/report.hpp"

#include <memory>

#include "cli/page.hpp"

namespace concord {

tl::expected<AgentList, Failure> hear_agents(Live& live) {
  const auto list = std::make_shared<std::optional<AgentList>>();  // the subscription outlives this call
  live.hear<AgentList>("out/agents", [list](const std::string&, AgentList heard) { *list = std::move(heard); });
  if (!live.wait(live.timeout(), [&] { return list->has_value(); })) return live.no_answer("merge");
  return **list;
}

std::array<double, 7> to_numbers(const Transform& transform) {
  const Eigen::Vector3d p = transform.translation();
  const Eigen::Quaterniond q(transform.linear());
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}

nlohmann::json to_json(const AgentState& agent) {
  return {{"id", agent.id},
          {"kind", agent.kind},
          {"frame", agent.frame_id},
          {"weight", agent.weight},
          {"aligned", agent.aligned},
          {"T_map_agent", agent.aligned ? nlohmann::json(to_numbers(agent.T_map_agent)) : nlohmann::json()},
          {"known", agent.known},
          {"occupied", agent.occupied},
          {"revision", agent.revision},
          {"synced", agent.synced}};
}

nlohmann::json to_json(const Path& path) {
  const bool found = path.status == "OK";
  nlohmann::json points = nlohmann::json::array();
  for (const Eigen::Vector3d& p : path.points) points.push_back({p.x(), p.y(), p.z()});
  return {{"status", path.status},
          {"message", path.message},
          {"length", found ? nlohmann::json(path.length) : nlohmann::json()},
          {"least_clearance", found ? nlohmann::json(path.least_clearance) : nlohmann::json()},
          {"map_revision", path.map_revision},
          {"plan_number", path.plan_number},
          {"active", path.active},
          {"points", points}};
}

nlohmann::json to_json(const Answer& answer) {
  return {{"process", answer.process},
          {"code", answer.code},
          {"message", answer.message},
          {"revision", answer.revision},
          {"count", answer.count}};
}

std::string to_words(const Path& path) {
  if (path.status != "OK") return path.status + ": " + path.message;
  return "path of " + format_number(path.length, 2) + " m, " + std::to_string(path.points.size()) +
         " points, least clearance " + format_number(path.least_clearance, 2) + " m" +
         (path.active ? "; it is kept up to date" : "");
}

}  // namespace concord
