// Requests about ways: paths, goals, virtual obstacles.

#include <algorithm>
#include <memory>

#include "bridge/requests.hpp"
#include "core/text.hpp"

namespace concord::hmd {
namespace {

constexpr std::int64_t kReplanPatience = 5'000'000;  // microseconds
constexpr std::int64_t kLook = 50'000;
constexpr std::int64_t kMaxInsideCells = 1'000'000;

/// @param is_aligned whether the robot has a place in the map: then it is its pose that nobody has heard of late
Code plan_code(const std::string& status, bool is_aligned) {
  if (status == "NO_MAP") return Code::kNoMap;
  if (status == "NO_POSE") return is_aligned ? Code::kStale : Code::kUnaligned;
  if (status == "BAD_REQUEST" || status == "BUSY" || status == "TIMEOUT" || status == "TOO_LARGE")
    return code_of(status);
  return Code::kUnreachable;
}

/// Asks the planner and answers with the path in the frame that was asked for.
template <class PathAnswerOf>
void plan(Desk& desk, const Ask& ask, concord::PathRequest request, Frame frame, PathAnswerOf answer_of) {
  const auto* robot = desk.world.agent(request.robot);
  if (robot == nullptr) return desk.hub.refuse(ask, Code::kNoRobot, "no robot is called " + request.robot);
  const bool is_aligned = robot->aligned;
  request.id = desk.id(ask);
  const std::string id = request.id;
  desk.paths.erase(id);
  desk.watched.insert(id);
  desk.asker.ask(
      {"in/path_request", encode(request, desk.now()), id, [&desk, id] { return desk.paths.contains(id); }, {}},
      [&desk, ask, id, frame, is_aligned, answer_of](const Answer& answer) {
        desk.watched.erase(id);
        const auto node = desk.paths.extract(id);
        if (!answer.ok)
          return desk.hub.refuse(ask, plan_code(answer.code, is_aligned), answer.code + ": " + answer.message);
        if (desk.hub.find(ask.session) == nullptr) return;
        const auto shown = desk.show(ask, node.mapped(), frame);
        if (!shown) return desk.refuse(ask, shown.error());
        desk.hub.answer(ask, answer_of(*shown));
      });
}

/// A robot with its disc in the volume's footprint, if any.
Granted<std::optional<std::string>> who_stands_in(Desk& desk, const concord::Volume& volume,
                                                  const Transform& T_map_frame) {
  const Site& site = desk.context.site;
  const auto cells =
      footprint(volume, T_map_frame, site.resolution, site.planner.zmin, site.planner.zmax, kMaxInsideCells);
  if (!cells) return no(cells.error());
  for (const auto& [robot, pose] : desk.world.poses()) {
    const Eigen::Vector2d at = pose.T_map_base.translation().head<2>();
    const double radius = site.agent(robot).radius;
    const bool inside = std::any_of(cells->begin(), cells->end(), [&](VoxelIndex cell) {
      const Eigen::Vector2d low(cell.x * site.resolution, cell.y * site.resolution);
      const Eigen::Vector2d nearest = at.cwiseMax(low).cwiseMin((low.array() + site.resolution).matrix());
      return (at - nearest).norm() < radius;
    });
    if (inside) return std::optional(robot);
  }
  return std::optional<std::string>();
}

/// Waits until every path that was active has been looked at on a map that holds what was made.
struct ReplanWait {
  std::map<std::string, std::int64_t> before;  ///< plan numbers, by robot
  std::map<std::string, std::string> status;   ///< then
  std::int64_t boot_id = 0;                    ///< of the map's sender then; 0: not known
  std::int64_t correction = 0;                 ///< what was made
  std::optional<std::int64_t> revision;        ///< of the map, from which on it holds that; nothing: not said yet
  std::int64_t until = 0;
  std::function<void(const std::vector<PathConsequence>&, bool in_time)> done;
};

/// What merge says of its map. A map that begins anew counts its revisions anew: then nobody can tell.
void note_revision(ReplanWait& wait, const MapEdits& said) {
  if (wait.boot_id == 0) wait.boot_id = said.boot_id;
  if (said.boot_id != wait.boot_id) return wait.revision.reset();
  if (!wait.revision && said.boot_id != 0 && said.edit_revision >= wait.correction) wait.revision = said.map_revision;
}

/// @param correction its revision, as merge answered it.
void await_replan(Desk& desk, std::shared_ptr<ReplanWait> wait, std::int64_t correction) {
  wait->correction = correction;
  wait->until = desk.now() + kReplanPatience;
  const auto alive = std::make_shared<bool>(true);
  auto owner = std::make_shared<std::shared_ptr<bool>>(alive);
  desk.context.bus.every(
      kLook,
      [&desk, wait, owner] {
        std::vector<PathConsequence> found;
        const bool late = desk.now() >= wait->until;
        note_revision(*wait, desk.world.map_edits());
        std::size_t seen = 0;
        for (const auto& [robot, number] : wait->before) {
          const concord::Path* path = desk.world.last_path(robot);  // a planner that is silent has not ended it
          if (path == nullptr) {
            ++seen;  // it ended meanwhile
            continue;
          }
          if (wait->revision && path->map_revision >= *wait->revision) ++seen;
          found.push_back({robot, cut_to(path->status, 40), path->plan_number != number, path->plan_number});
        }
        const bool all = seen == wait->before.size();
        if (!late && !all) return;
        owner->reset();  // this timer goes
        wait->done(found, all);
      },
      alive);
}

std::shared_ptr<ReplanWait> paths_now(Desk& desk) {
  auto wait = std::make_shared<ReplanWait>();
  wait->boot_id = desk.world.map_edits().boot_id;
  for (const concord::Path* path : desk.world.active_paths()) {
    if (wait->before.size() >= 100) break;
    wait->before[path->robot] = path->plan_number;
    wait->status[path->robot] = path->status;
  }
  return wait;
}

/// Also where nobody listens any more.
void take_back(Desk& desk, const Ask& ask, const concord::EditRequest& edit, Code code, const std::string& why) {
  const concord::UndoRequest undo{edit.id + "-back", edit.author, edit.id, false, desk.now()};
  desk.asker.ask({"in/undo", encode(undo), undo.id, {}, {}}, [&desk, ask, code, why](const Answer& answer) {
    desk.hub.refuse(ask, code,
                    why + (answer.ok ? "; it was taken back" : "; and it could not be taken back: " + answer.message));
  });
}

}  // namespace

void work_on(Desk& desk, const Ask& ask, const PathRequest& request) {
  if (desk.world.agent(request.robot) == nullptr)
    return desk.hub.refuse(ask, Code::kNoRobot, "no robot is called " + request.robot);
  Session& session = *desk.hub.find(ask.session);
  if (const auto where = desk.place(ask, request.frame); !where) return desk.refuse(ask, where.error());
  if (request.follow) {
    session.path_frames[request.robot] = request.frame;
  } else {
    session.path_frames.erase(request.robot);
    session.outbox.forget("path/" + request.robot);
  }
  const concord::Path* path = desk.world.active_path(request.robot);
  const auto shown = desk.show(ask, path != nullptr ? *path : Desk::no_path(request.robot), request.frame);
  if (!shown) return desk.refuse(ask, shown.error());
  desk.hub.answer(ask, PathAnswer{*shown});
}

void work_on(Desk& desk, const Ask& ask, const PlanRequest& request) {
  const auto where = desk.place(ask, request.frame);
  if (!where) return desk.refuse(ask, where.error());
  concord::PathRequest path;
  path.robot = request.robot;
  if (request.start) path.start = (where->T_map_frame * Eigen::Vector3d(vector_of(*request.start))).head<2>();
  path.goal = (where->T_map_frame * Eigen::Vector3d(vector_of(request.goal))).head<2>();
  plan(desk, ask, std::move(path), request.frame, [](const Path& shown) { return PlanAnswer{shown}; });
}

void work_on(Desk& desk, const Ask& ask, const GoalRequest& request) {
  const auto T_map_goal = desk.in_map(ask, request.frame, request.T_frame_goal);
  if (!T_map_goal) return desk.refuse(ask, T_map_goal.error());
  concord::PathRequest path;
  path.robot = request.robot;
  path.goal = T_map_goal->translation().head<2>();
  path.keep_active = true;
  plan(desk, ask, std::move(path), request.frame, [](const Path& shown) { return GoalAnswer{shown}; });
}

void work_on(Desk& desk, const Ask& ask, const ObstacleAddRequest& request) {
  const auto where = desk.place(ask, request.frame);
  if (!where) return desk.refuse(ask, where.error());
  const auto volume = from_hmd(request.volume);
  if (!volume) return desk.refuse(ask, {code_of(volume.error()), volume.error().message});
  const auto inside = who_stands_in(desk, *volume, where->T_map_frame);
  if (!inside) return desk.refuse(ask, inside.error());
  if (*inside) return desk.hub.refuse(ask, Code::kRobotInside, **inside + " stands there");

  concord::EditRequest edit;
  edit.id = desk.id(ask);
  edit.author = desk.author(ask);
  edit.shape = std::visit([](const auto& part) -> concord::Shape { return part; }, *volume);
  edit.frame = where->frame;
  edit.base_revision = request.base_revision.value_or(kAnyRevision);
  edit.utime = desk.now();
  auto wait = paths_now(desk);
  desk.asker.ask({"in/edit", encode(edit), edit.id, {}, {}}, [&desk, ask, wait, edit](const Answer& answer) {
    if (!answer.ok) return desk.hub.refuse(ask, code_of(answer.code), answer.message);
    wait->done = [&desk, ask, before = wait->status, edit, answer](const std::vector<PathConsequence>& paths,
                                                                   bool in_time) {
      for (const PathConsequence& path : paths) {
        if (before.at(path.robot) != "OK" || path.status == "OK") continue;
        return take_back(desk, ask, edit, Code::kNoPath,
                         "it leaves " + path.robot + " without a path (" + path.status + ")");
      }
      if (!in_time)
        return take_back(desk, ask, edit, Code::kTimeout, "whether robots have a way around it was not said in 5 s");
      desk.hub.answer(ask, ObstacleAddAnswer{edit.id, answer.revision, answer.count, paths});
    };
    await_replan(desk, wait, answer.revision);
  });
}

void work_on(Desk& desk, const Ask& ask, const ObstacleRemoveRequest& request) {
  if (!is_request_id(request.obstacle)) return desk.hub.refuse(ask, Code::kNotFound, "no obstacle has this id");
  const concord::UndoRequest undo{desk.id(ask), desk.author(ask), request.obstacle, false, desk.now()};
  auto wait = paths_now(desk);
  desk.asker.ask({"in/undo", encode(undo), undo.id, {}, {}}, [&desk, ask, wait](const Answer& answer) {
    if (!answer.ok) return desk.hub.refuse(ask, code_of(answer.code), answer.message);
    wait->done = [&desk, ask, answer](const std::vector<PathConsequence>& paths, bool) {
      desk.hub.answer(ask, ObstacleRemoveAnswer{answer.revision, paths});
    };
    await_replan(desk, wait, answer.revision);
  });
}

}  // namespace concord::hmd
