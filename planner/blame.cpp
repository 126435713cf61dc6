#include "planner/blame.hpp"

#include <algorithm>

namespace concord {
namespace {

CellRectangle around_both(const CellRectangle& a, const CellRectangle& b) {
  return {{std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y)},
          {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y)}};
}

/// The cells of the map on a way between the points, as if something were not there; empty: there is none.
std::vector<Cell> way_without(const RobotTask& task, Ignoring what, const Eigen::Vector2d& from,
                              const Eigen::Vector2d& to) {
  Areas& areas = task.grids.areas();
  const auto here = areas.around(cell_of(from));
  const auto there = areas.around(cell_of(to));
  if (!here || !there) return {};
  if (what != Ignoring::kUnobserved && !areas.together(cell_of(from), cell_of(to))) return {};
  const auto grid = task.grids.at(task.in_cells(), what, around_both(*here, *there));
  if (grid == nullptr) return {};
  const std::vector<Cell> goals = anchors(grid->space(), to);
  for (const Cell start : anchors(grid->space(), from)) {
    for (const Cell goal : goals) {
      const auto path = grid->paths().fast(grid->local(start), grid->local(goal));
      if (!path) continue;
      std::vector<Cell> cells;
      for (const Cell cell : cells_of(path->turns)) cells.push_back(grid->global(cell));
      return cells;
    }
  }
  return {};
}

/// "'a', 'b' and 2 more", of those that the way leads through, in its order.
std::string zones_on(const RobotTask& task, FreeSpace& space, const std::vector<Cell>& way) {
  constexpr std::size_t kNamed = 3;
  std::vector<std::string> names;
  for (const Cell cell : way) {
    if (space.is_open(cell)) continue;
    const auto zone = task.terrain().zones().nearest_no_go(centre_of(cell), task.in_cells() + kTouch);
    if (zone && std::find(names.begin(), names.end(), zone->name) == names.end()) names.push_back(zone->name);
  }
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kNamed); ++i) text += (i == 0 ? "'" : ", '") + names[i] + "'";
  return names.size() > kNamed ? text + " and " + std::to_string(names.size() - kNamed) + " more" : text;
}

/// In how many stretches of the way its cells are closed.
std::size_t closed_stretches(FreeSpace& space, const std::vector<Cell>& way) {
  std::size_t count = 0;
  bool was_open = true;
  for (const Cell cell : way) {
    const bool is_open = space.is_open(cell);
    count += was_open && !is_open ? 1 : 0;
    was_open = is_open;
  }
  return count;
}

std::string at_place(const Eigen::Vector2d& p) { return describe({"place", p, {}, {}, {}, {}, {}}); }

}  // namespace

Finding what_closes(const RobotTask& task, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  FreeSpace space(task.terrain(), task.in_cells());
  Finding finding{
      Reason::kNoValidPath, "no way through: walls, or space not yet observed, cut the goal off", {}, 0, {}, false};
  const auto blame = [&](Reason reason, const std::vector<Cell>& way, const std::string& message) {
    finding.reason = reason;
    const auto closed = std::find_if(way.begin(), way.end(), [&](Cell cell) { return !space.is_open(cell); });
    if (closed != way.end()) finding.cut = centre_of(*closed) * task.terrain().resolution();
    finding.message = "no way through: " + message + (finding.cut ? ", at " + at_place(*finding.cut) : "");
  };
  if (!task.terrain().robots().empty()) {
    const std::vector<Cell> way = way_without(task, Ignoring::kRobots, from, to);
    const auto closed = std::find_if(way.begin(), way.end(), [&](Cell cell) { return !space.is_open(cell); });
    if (closed != way.end()) {
      const std::string robot = task.terrain().robots().robot_near(centre_of(*closed), task.in_cells() + 1);
      blame(Reason::kNoValidPath, way, (robot.empty() ? "another robot" : robot) + " stands in the way");
      return finding;
    }
  }
  if (task.terrain().zones().has_no_go()) {
    const std::vector<Cell> way = way_without(task, Ignoring::kNoGo, from, to);
    const std::string names = zones_on(task, space, way);
    if (!way.empty()) {
      blame(Reason::kNoValidPath, way,
            "no-go zones cut the goal off; without them there is a way" + (names.empty() ? "" : ", through " + names));
      return finding;
    }
  }
  if (task.terrain().grid().has_pinned()) {
    const std::vector<Cell> way = way_without(task, Ignoring::kPins, from, to);
    if (!way.empty()) {
      const std::size_t count = closed_stretches(space, way);
      blame(Reason::kBlockedByEdit, way,
            count < 2 ? "an edit cuts the goal off; without it there is a way"
                      : "edits in " + std::to_string(count) +
                            " places cut the goal off; without all of them there is a way: the first");
      return finding;
    }
  }
  const std::vector<Cell> way = way_without(task, Ignoring::kUnobserved, from, to);
  if (!way.empty()) blame(Reason::kBlockedByUnknown, way, "space not yet observed cuts the goal off");
  return finding;
}

}  // namespace concord
