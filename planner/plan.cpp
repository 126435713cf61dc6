#include "planner/plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <span>

#include "planner/clearance.hpp"
#include "planner/free_space.hpp"
#include "planner/route.hpp"
#include "planner/search.hpp"

namespace concord {
namespace {

/// Cells of a first look: some 10 ms.
constexpr std::int64_t kLook = 65'536;

using Points = std::vector<Eigen::Vector2d>;

PlanResult refusal(Reason reason, std::string message) {
  PlanResult result;
  result.reason = reason;
  result.message = std::move(message);
  return result;
}

std::string metres(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.2f m", value);
  return text.data();
}

std::string describe(const char* what, const Eigen::Vector2d& p) {
  std::array<char, 96> text;
  std::snprintf(text.data(), text.size(), "the %s (%.2f, %.2f)", what, p.x(), p.y());
  return text.data();
}

std::string no_go(const std::string& zone) { return "the no-go zone '" + zone + "'"; }

/// Whether the cell lies in the smallest rectangle of 8 x 8 columns that holds all known cells.
bool is_inside(const Grid& grid, Cell cell) {
  BrickIndex low{kMaxVoxel, kMaxVoxel, 0};
  BrickIndex high{-kMaxVoxel, -kMaxVoxel, 0};
  grid.cells().for_each_brick([&](BrickIndex b, const Brick&) {
    low = {std::min(low.x, b.x), std::min(low.y, b.y), 0};
    high = {std::max(high.x, b.x), std::max(high.y, b.y), 0};
  });
  const BrickIndex b{cell.x >> 3, cell.y >> 3, 0};
  return b.x >= low.x && b.x <= high.x && b.y >= low.y && b.y <= high.y;
}

/// One end of the path and the reasons that are its own.
struct End {
  const char* what;
  Eigen::Vector2d position;  ///< metres
  Reason outside, no_go, occupied, unknown, clearance;
};

std::optional<PlanResult> check_cell(const Grid& grid, const ZoneLayer& zones, const End& end) {
  const Eigen::Vector2d p_cells = end.position / grid.resolution();
  const std::string where = describe(end.what, end.position);
  if (p_cells.cwiseAbs().maxCoeff() >= kMaxVoxel) return refusal(end.outside, where + " lies outside the map");
  const Cell cell = cell_of(p_cells);
  const LogOdds state = grid.at(cell);
  if (const std::string* zone = zones.no_go_at(cell)) {
    const char* too = is_free(state) ? "" : is_known(state) ? ", and is occupied" : ", and has not been observed free";
    return refusal(end.no_go, where + " lies in " + no_go(*zone) + too);
  }
  if (is_free(state)) return std::nullopt;
  if (is_known(state)) return refusal(end.occupied, where + " is occupied");
  if (is_inside(grid, cell)) return refusal(end.unknown, where + " has not been observed free");
  return refusal(end.outside, where + " lies outside the map");
}

/// What is planned on, and for whom.
struct Task {
  const Grid& grid;
  const ZoneLayer& zones;
  double radius;  ///< metres

  [[nodiscard]] double in_cells() const { return radius / grid.resolution(); }
};

double least_clearance(const Task& task, std::span<const Eigen::Vector2d> points, Against against) {
  // Ends, because beyond the map all is unknown, and zones end.
  for (double reach = task.radius + 4 * task.grid.resolution();; reach *= 2) {
    if (const auto found = clearance(task.grid, points, reach, task.zones, against)) return *found;
  }
}

/// What a robot at `end` would overlap.
PlanResult too_near(const Task& task, const End& end) {
  double gap = least_clearance(task, {&end.position, 1}, Against::kUntouchable);
  // Where contact is allowed its body is clear, but its centre touches what it may not enter.
  if (gap >= task.radius) gap = least_clearance(task, {&end.position, 1}, Against::kImpassable);
  const double r = task.grid.resolution();
  const Eigen::Vector2d p = end.position / r;
  const auto zone = task.zones.nearest_no_go(p, gap / r + kTouch);
  FreeSpace without(task.grid, task.in_cells(), task.zones, FreeSpace::NoGo::kIgnored);
  const bool is_zone_alone = zone && without.sees(p, p);
  return refusal(end.clearance, describe(end.what, end.position) + " is " + metres(gap) + " from " +
                                    (zone ? no_go(zone->name) : "the nearest wall or unobserved cell") +
                                    ", the robot needs " + metres(task.radius) +
                                    (zone && !is_zone_alone ? "; a wall or unobserved cell is too near as well" : ""));
}

/// Scales back to metres, keeps both ends exact, and lets the validator have the last word.
PlanResult finish(const Task& task, Points points, const End& start, const End& goal) {
  for (Eigen::Vector2d& p : points) p *= task.grid.resolution();
  points.front() = start.position;
  points.back() = goal.position;
  PlanResult result;
  if (!is_clear(task.grid, points, task.radius, task.zones)) {
    return refusal(Reason::kValidationFailed, "the path that was found does not stand the final check: report this");
  }
  result.reason = Reason::kOk;
  for (std::size_t i = 1; i < points.size(); ++i) result.length += (points[i] - points[i - 1]).norm();
  result.least_clearance = least_clearance(task, points, Against::kImpassable);
  result.points = std::move(points);
  result.message = "a path of " + metres(result.length) + ", at least " + metres(result.least_clearance) +
                   " from anything occupied or unknown" + (task.zones.has_no_go() ? " and from no-go zones" : "");
  return result;
}

/// "'a', 'b' and 2 more", of those that the way would lead through, in its order.
std::string zones_on(const Task& task, FreeSpace& space, const std::vector<Cell>& way) {
  constexpr std::size_t kNamed = 3;
  std::vector<std::string> names;
  for (const Cell cell : way) {
    if (space.is_open(cell)) continue;
    const auto zone = task.zones.nearest_no_go(centre_of(cell), task.in_cells() + kTouch);
    if (zone && std::find(names.begin(), names.end(), zone->name) == names.end()) names.push_back(zone->name);
  }
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kNamed); ++i) text += (i == 0 ? "'" : ", '") + names[i] + "'";
  return names.size() > kNamed ? text + " and " + std::to_string(names.size() - kNamed) + " more" : text;
}

/// What closes the way, as far as looking for one as if there were no no-go zones tells, with about the effort that it
/// took to find none. Zones are only named if there is a way without them: a wall may close it as well. Notes that way.
std::string what_closes(const Task& task, FreeSpace& space, const std::array<Eigen::Vector2d, 2>& p,
                        PlanResult& result) {
  const std::string walls = "walls, or space not yet observed, cut the goal off";
  if (!space.met_no_go()) return walls;
  FreeSpace without(task.grid, task.in_cells(), task.zones, FreeSpace::NoGo::kIgnored);
  const std::vector<Anchor> starts = anchors(without, p[0]);
  const std::vector<Anchor> goals = anchors(without, p[1]);
  if (starts.empty() || goals.empty()) return walls;
  const CellPath way = find_path(without, starts, goals, result.expanded + kLook);
  result.expanded += way.expanded;
  if (way.status == CellPath::Status::kGaveUp) return "no-go zones, walls or space not yet observed cut the goal off";
  if (way.status != CellPath::Status::kFound) return walls;
  result.but_for_zones = Region(without.reach() + 1);
  for (const Cell cell : way.cells) result.but_for_zones.add(cell);
  const std::string names = zones_on(task, space, way.cells);
  return "no-go zones cut the goal off; without them there is a way" + (names.empty() ? "" : ", through " + names);
}

/// A straight line counts as tried, too; it may be free where no cell's centre is near.
void add_line(Region& region, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const int steps = static_cast<int>((to - from).norm() / 4) + 1;
  for (int i = 0; i <= steps; ++i) region.add(cell_of(from + (to - from) * i / steps));
}

PlanResult no_path(const Task& task, FreeSpace& space, const std::array<Eigen::Vector2d, 2>& p, CellPath found) {
  const bool gave_up = found.status == CellPath::Status::kGaveUp;
  PlanResult result = refusal(gave_up ? Reason::kSearchLimit : Reason::kNoValidPath, "");
  result.expanded = found.expanded;
  result.message = gave_up ? "no path within " + std::to_string(kMaxExpanded) + " cells: the map is too big"
                           : "no way through: " + what_closes(task, space, p, result);
  result.reached = std::move(found.reached);
  add_line(result.reached, p[0], p[1]);
  return result;
}

/// Either end may be shut in, most often in a small place: a look from both comes before a long search.
CellPath find_from_both_ends(FreeSpace& space, std::span<const Anchor> starts, std::span<const Anchor> goals) {
  const CellPath there = find_path(space, starts, goals, kLook);
  if (there.status != CellPath::Status::kGaveUp) return there;
  const CellPath back = find_path(space, goals, starts, kLook);
  const bool is_shut_in = back.status == CellPath::Status::kNone;
  CellPath path = is_shut_in ? back : find_path(space, starts, goals, kMaxExpanded);
  path.expanded = there.expanded + back.expanded + (is_shut_in ? 0 : path.expanded);
  return path;
}

PlanResult search(const Task& task, const End& start, const End& goal) {
  FreeSpace space(task.grid, task.in_cells(), task.zones);
  const std::array<const End*, 2> ends{&start, &goal};
  std::array<Eigen::Vector2d, 2> p;
  std::array<std::vector<Anchor>, 2> near;
  for (std::size_t i = 0; i < 2; ++i) {
    p[i] = ends[i]->position / task.grid.resolution();
    if (!space.sees(p[i], p[i])) return too_near(task, *ends[i]);
  }
  if (space.sees(p[0], p[1])) return finish(task, {p[0], p[1]}, start, goal);
  for (std::size_t i = 0; i < 2; ++i) {
    near[i] = anchors(space, p[i]);
    if (near[i].empty()) {
      return refusal(ends[i]->clearance, describe(ends[i]->what, ends[i]->position) +
                                             " is too narrow a place for a robot of radius " + metres(task.radius));
    }
  }
  CellPath found = find_from_both_ends(space, near[0], near[1]);
  if (found.status != CellPath::Status::kFound) return no_path(task, space, p, std::move(found));
  Points points{p[0]};
  for (const Cell cell : found.cells) points.push_back(centre_of(cell));
  points.push_back(p[1]);
  PlanResult result = finish(task, shorten(space, points), start, goal);
  result.expanded = found.expanded;
  return result;
}

}  // namespace

const char* name(Reason reason) {
  switch (reason) {
    case Reason::kOk: return "OK";
    case Reason::kBadRequest: return "BAD_REQUEST";
    case Reason::kNoMap: return "NO_MAP";
    case Reason::kNoPose: return "NO_POSE";
    case Reason::kStartOutsideMap: return "START_OUTSIDE_MAP";
    case Reason::kGoalOutsideMap: return "GOAL_OUTSIDE_MAP";
    case Reason::kNoZones: return "NO_ZONES";
    case Reason::kStartInNoGo: return "START_IN_NO_GO";
    case Reason::kGoalInNoGo: return "GOAL_IN_NO_GO";
    case Reason::kStartOccupied: return "START_OCCUPIED";
    case Reason::kGoalOccupied: return "GOAL_OCCUPIED";
    case Reason::kStartUnknown: return "START_UNKNOWN";
    case Reason::kGoalUnknown: return "GOAL_UNKNOWN";
    case Reason::kStartClearance: return "START_CLEARANCE";
    case Reason::kGoalClearance: return "GOAL_CLEARANCE";
    case Reason::kNoValidPath: return "NO_VALID_PATH";
    case Reason::kSearchLimit: return "SEARCH_LIMIT";
    case Reason::kValidationFailed: return "VALIDATION_FAILED";
  }
  return "BAD_REQUEST";
}

PlanResult plan(const Grid& grid, const Eigen::Vector2d& start, const Eigen::Vector2d& goal, double radius,
                const ZoneLayer& zones) {
  if (!start.allFinite() || !goal.allFinite() || !std::isfinite(radius)) {
    return refusal(Reason::kBadRequest, "start, goal and radius must be numbers, in metres");
  }
  if (radius < 0 || radius > kMaxRadius || radius / grid.resolution() > kMaxRadiusCells) {
    return refusal(Reason::kBadRequest, "the robot's radius must be from 0 to " +
                                            metres(std::min(kMaxRadius, kMaxRadiusCells * grid.resolution())));
  }
  if (grid.cells().empty()) return refusal(Reason::kNoMap, "nothing has been observed in the height band yet");
  const End from{"start",
                 start,
                 Reason::kStartOutsideMap,
                 Reason::kStartInNoGo,
                 Reason::kStartOccupied,
                 Reason::kStartUnknown,
                 Reason::kStartClearance};
  const End to{"goal",
               goal,
               Reason::kGoalOutsideMap,
               Reason::kGoalInNoGo,
               Reason::kGoalOccupied,
               Reason::kGoalUnknown,
               Reason::kGoalClearance};
  if (auto refused = check_cell(grid, zones, from)) return *refused;
  if (auto refused = check_cell(grid, zones, to)) return *refused;
  return search({grid, zones, radius}, from, to);
}

}  // namespace concord
