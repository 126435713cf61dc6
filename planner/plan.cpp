#include "planner/plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <span>

#include "planner/clearance.hpp"
#include "planner/free_space.hpp"
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

Cell cell_of(const Eigen::Vector2d& p_cells) {
  return {static_cast<std::int32_t>(std::floor(p_cells.x())), static_cast<std::int32_t>(std::floor(p_cells.y()))};
}

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
  Reason outside, occupied, unknown, clearance;
};

std::optional<PlanResult> check_cell(const Grid& grid, const End& end) {
  const Eigen::Vector2d p_cells = end.position / grid.resolution();
  const std::string where = describe(end.what, end.position);
  if (p_cells.cwiseAbs().maxCoeff() >= kMaxVoxel) return refusal(end.outside, where + " lies outside the map");
  const Cell cell = cell_of(p_cells);
  const LogOdds state = grid.at(cell);
  if (is_free(state)) return std::nullopt;
  if (is_known(state)) return refusal(end.occupied, where + " is occupied");
  if (is_inside(grid, cell)) return refusal(end.unknown, where + " has not been observed free");
  return refusal(end.outside, where + " lies outside the map");
}

std::int64_t cost_of(double cells) { return std::llround(cells * static_cast<double>(kStraight)); }

Eigen::Vector2d centre_of(Cell cell) { return {cell.x + 0.5, cell.y + 0.5}; }

/// The cells around `p` (in cells) that the robot can go to in a straight line. Those one step away from p's own are
/// left out where that one serves: the search gets there by itself.
std::vector<Anchor> anchors(FreeSpace& space, const Eigen::Vector2d& p) {
  const Cell own = cell_of(p);
  const auto serves = [&](int dx, int dy) {
    const Cell cell{own.x + dx, own.y + dy};
    return space.is_open(cell) && space.sees(p, centre_of(cell));
  };
  std::vector<Anchor> found;
  const bool own_serves = serves(0, 0);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const Cell cell{own.x + dx, own.y + dy};
      const bool is_own = dx == 0 && dy == 0;
      const bool is_one_step =
          !is_own && own_serves && space.is_open({cell.x, own.y}) && space.is_open({own.x, cell.y});
      if (is_one_step || !serves(dx, dy)) continue;
      found.push_back({cell, cost_of((centre_of(cell) - p).norm())});
    }
  }
  return found;
}

/// The furthest of `points` that can be seen from `from`, as far as doubling and then halving of the step tells.
std::size_t furthest_seen(FreeSpace& space, const Points& points, std::size_t from) {
  const auto seen = [&](std::size_t to) { return space.sees(points[from], points[to]); };
  const std::size_t last = points.size() - 1;
  std::size_t good = from + 1;  // each point sees the next: that is how they were found
  std::size_t step = 1;
  while (good < last && seen(std::min(good + step, last))) {
    good = std::min(good + step, last);
    step *= 2;
  }
  for (step /= 2; step > 0; step /= 2) {
    if (good + step <= last && seen(good + step)) good += step;
  }
  return good;
}

/// Leaves out every point that the path can do without, first from one end, then each that is left.
Points shorten(FreeSpace& space, const Points& points) {
  Points path{points.front()};
  for (std::size_t i = 0; i + 1 < points.size(); path.push_back(points[i])) i = furthest_seen(space, points, i);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 1; i + 1 < path.size();) {
      if (!space.sees(path[i - 1], path[i + 1])) {
        ++i;
        continue;
      }
      path.erase(path.begin() + static_cast<std::ptrdiff_t>(i));
      changed = true;
    }
  }
  return path;
}

double least_clearance(const Grid& grid, std::span<const Eigen::Vector2d> points, double radius) {
  for (double reach = radius + 4 * grid.resolution();; reach *= 2) {  // ends, because beyond the map all is unknown
    if (const std::optional<double> found = clearance(grid, points, reach)) return *found;
  }
}

/// Scales back to metres, keeps both ends exact, and lets the validator have the last word.
PlanResult finish(const Grid& grid, Points points, const End& start, const End& goal, double radius) {
  for (Eigen::Vector2d& p : points) p *= grid.resolution();
  points.front() = start.position;
  points.back() = goal.position;
  PlanResult result;
  if (!is_clear(grid, points, radius)) {
    return refusal(Reason::kValidationFailed, "the path that was found does not stand the final check: report this");
  }
  result.reason = Reason::kOk;
  for (std::size_t i = 1; i < points.size(); ++i) result.length += (points[i] - points[i - 1]).norm();
  result.least_clearance = least_clearance(grid, points, radius);
  result.points = std::move(points);
  result.message = "a path of " + metres(result.length) + ", at least " + metres(result.least_clearance) +
                   " from anything occupied or unknown";
  return result;
}

PlanResult no_path(const CellPath& path) {
  if (path.status == CellPath::Status::kGaveUp) {
    return refusal(Reason::kSearchLimit,
                   "no path within " + std::to_string(kMaxExpanded) + " cells: the map is too big");
  }
  return refusal(Reason::kNoValidPath, "no way through: walls, or space not yet observed, cut the goal off");
}

/// A straight line counts as tried, too; it may be free where no cell's centre is near.
void add_line(Region& region, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const int steps = static_cast<int>((to - from).norm() / 4) + 1;
  for (int i = 0; i <= steps; ++i) region.add(cell_of(from + (to - from) * i / steps));
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

PlanResult search(const Grid& grid, const End& start, const End& goal, double radius) {
  FreeSpace space(grid, radius / grid.resolution());
  const std::array<const End*, 2> ends{&start, &goal};
  std::array<Eigen::Vector2d, 2> p;
  std::array<std::vector<Anchor>, 2> near;
  for (std::size_t i = 0; i < 2; ++i) {
    p[i] = ends[i]->position / grid.resolution();
    const std::string where = describe(ends[i]->what, ends[i]->position);
    if (!space.sees(p[i], p[i])) {
      return refusal(ends[i]->clearance,
                     where + " is " + metres(least_clearance(grid, {&ends[i]->position, 1}, radius)) +
                         " from the nearest wall or unobserved cell, the robot needs " + metres(radius));
    }
  }
  if (space.sees(p[0], p[1])) return finish(grid, {p[0], p[1]}, start, goal, radius);
  for (std::size_t i = 0; i < 2; ++i) {
    near[i] = anchors(space, p[i]);
    if (near[i].empty()) {
      return refusal(ends[i]->clearance, describe(ends[i]->what, ends[i]->position) +
                                             " is too narrow a place for a robot of radius " + metres(radius));
    }
  }
  const CellPath found = find_from_both_ends(space, near[0], near[1]);
  PlanResult result;
  if (found.status != CellPath::Status::kFound) {
    result = no_path(found);
    result.reached = found.reached;
    add_line(result.reached, p[0], p[1]);
  } else {
    Points points{p[0]};
    for (const Cell cell : found.cells) points.push_back(centre_of(cell));
    points.push_back(p[1]);
    result = finish(grid, shorten(space, points), start, goal, radius);
  }
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

PlanResult plan(const Grid& grid, const Eigen::Vector2d& start, const Eigen::Vector2d& goal, double radius) {
  if (!start.allFinite() || !goal.allFinite() || !std::isfinite(radius)) {
    return refusal(Reason::kBadRequest, "start, goal and radius must be numbers, in metres");
  }
  if (radius < 0 || radius > kMaxRadius || radius / grid.resolution() > kMaxRadiusCells) {
    return refusal(Reason::kBadRequest, "the robot's radius must be from 0 to " +
                                            metres(std::min(kMaxRadius, kMaxRadiusCells * grid.resolution())));
  }
  if (grid.cells().empty()) return refusal(Reason::kNoMap, "nothing has been observed in the height band yet");
  const End from{
      "start", start, Reason::kStartOutsideMap, Reason::kStartOccupied, Reason::kStartUnknown, Reason::kStartClearance};
  const End to{
      "goal", goal, Reason::kGoalOutsideMap, Reason::kGoalOccupied, Reason::kGoalUnknown, Reason::kGoalClearance};
  if (auto refused = check_cell(grid, from)) return *refused;
  if (auto refused = check_cell(grid, to)) return *refused;
  return search(grid, from, to, radius);
}

}  // namespace concord
