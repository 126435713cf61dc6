#include "cli/report.hpp"

#include <pwd.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>

#include "cli/numbers.hpp"

namespace concord {
namespace {

std::string done(const Answer& answer) {
  return answer.process + ": " + (answer.message.empty() ? "done" : answer.message);
}

}  // namespace

tl::expected<AgentList, Failure> hear_agents(Live& live) {
  const auto list = std::make_shared<std::optional<AgentList>>();  // the subscription outlives this call
  live.hear<AgentList>("out/agents", [list](const std::string&, AgentList heard) { *list = std::move(heard); });
  if (!live.wait(live.timeout(), [&] { return list->has_value(); })) return live.no_answer("merge");
  return **list;
}

std::string author_or_user(const std::string& author) {
  if (!author.empty()) return author;
  const auto is_usable = [](const char* name) { return name != nullptr && *name != '\0' && is_author(name); };
  if (const char* user = std::getenv("USER"); is_usable(user)) return user;
  // $USER is no more than a shell's habit: programs that are started otherwise lack it.
  const passwd* login = getpwuid(getuid());
  if (login != nullptr && is_usable(login->pw_name)) return login->pw_name;
  return "uid-" + std::to_string(getuid());
}

tl::unexpected<Failure> bad_name(const std::string& name) {
  return fail(Exit::kUnusable, "BAD_NAME", "'" + name + "' is no name: " + kNameRule);
}

Result<void> check_id(const std::string& id) {
  if (is_request_id(id)) return {};
  return refuse(Code::kBadName, "'" + id + "' is no id: " + kIdRule);
}

Result<void> check_own_id(const std::string& id) { return id.empty() ? Result<void>() : check_id(id); }

Outcome print_answer(const tl::expected<Answer, Failure>& answer, const Common& common) {
  if (!answer) return tl::unexpected(answer.error());
  common.print(to_json(*answer), done(*answer));
  return Exit::kDone;
}

Outcome print_revision(const tl::expected<Answer, Failure>& answer, const Common& common) {
  if (!answer) return tl::unexpected(answer.error());
  common.print(to_json(*answer),
               done(*answer) + "\nid " + answer->id + ", revision " + std::to_string(answer->revision));
  return Exit::kDone;
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
  nlohmann::json details = nlohmann::json::array();
  for (const PathPoint& point : path.details) {
    details.push_back({{"yaw", point.yaw}, {"clearance", point.clearance}, {"leg", point.leg}, {"eta", point.eta}});
  }
  return {{"status", path.status},
          {"message", path.message},
          {"length", found ? nlohmann::json(path.length) : nlohmann::json()},
          {"least_clearance", found ? nlohmann::json(path.least_clearance) : nlohmann::json()},
          {"map_revision", path.map_revision},
          {"plan_number", path.plan_number},
          {"active", path.active},
          {"path_id", path.path_id},
          {"superseded", path.superseded},
          {"edit_id", path.edit_id},
          {"failed_leg", path.failed_leg},
          {"nearest", path.nearest ? nlohmann::json{path.nearest->x(), path.nearest->y()} : nlohmann::json()},
          {"zones", path.zones},
          {"radius", path.radius},
          {"frame", path.frame_agent},
          {"details", details},
          {"points", points}};
}

nlohmann::json to_json(const Answer& answer) {
  return {{"id", answer.id},           {"process", answer.process},   {"code", answer.code},
          {"message", answer.message}, {"revision", answer.revision}, {"count", answer.count}};
}

std::string to_words(const Path& path) {
  const char* kept = "; it is kept up to date until the robot's next goal (concord paths)";
  const char* tried = "; it is tried again as the map changes, until the robot's next goal (concord paths)";
  const std::string nearest = path.nearest
                                  ? "; the nearest place that can be reached is " +
                                        format_number(path.nearest->x(), 2) + " " + format_number(path.nearest->y(), 2)
                                  : "";
  if (path.status != "OK") return path.status + ": " + path.message + nearest + (path.active ? tried : "");
  return "path of " + format_number(path.length, 2) + " m, " + std::to_string(path.points.size()) +
         " points, least clearance " + format_number(path.least_clearance, 2) + " m" + (path.active ? kept : "");
}

Exit print_path(const Path& path, const Common& common) {
  common.print(to_json(path), to_words(path));
  return path.status == "OK" ? Exit::kDone : Exit::kNegative;
}

Overview::Route to_route(const Path& path) {
  Overview::Route route{path.status, {}, path.length, path.message};
  for (const Eigen::Vector3d& p : path.points) route.points.emplace_back(p.head<2>());
  return route;
}

}  // namespace concord
