#include "planner/se2/pose_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "planner/footprint/hull_cells.hpp"
#include "planner/se2/narrow_cells.hpp"
#include "planner/se2/shorten_motions.hpp"

namespace concord {
namespace {

constexpr std::array kDensities{GuideDensity{1, 0}, GuideDensity{0.5, 8}, GuideDensity{0.25, 16}};
constexpr std::uint64_t kSeed = 20'260'101;
/// So often is the grid path led round a place that is too narrow.
constexpr int kMostDetours = 30;

Cell cell_of(const Eigen::Vector2d& p) {
  return {static_cast<std::int32_t>(std::floor(p.x())), static_cast<std::int32_t>(std::floor(p.y()))};
}

/// So far must the distance field see that discs around the footprint can be told to be clear.
int reach_for(const Footprint& footprint) {
  constexpr double kMore = 14;
  return static_cast<int>(std::min<double>(DistanceField::kMaxReach, std::ceil(footprint.circumscribed()) + kMore));
}

/// The grid path keeps that far from where the inner disc does not fit, that the outer one fits where there is room.
int margin_for(const Footprint& footprint) {
  const double apart = std::ceil(footprint.circumscribed() - footprint.inscribed()) + 2;
  return static_cast<int>(std::clamp<double>(apart, GridPaths::kReach, DistanceField::kMaxReach));
}

/// Poses at the ends of all steps; of a line, its ends.
void append_poses(const StandingRoom& room, const Motion& motion, std::vector<Pose>& poses) {
  for_each_move(motion, [&](const Pose& at, const Move& move) {
    const int count = move.turn == 0 ? 1 : room.steps(move);
    for (int i = 1; i <= count; ++i) poses.push_back(move.from(at, static_cast<double>(i) / count));
    return true;
  });
  poses.back() = motion.to;
}

/// Leaves out what lies between two lines in one direction.
std::vector<Pose> without_flat(const std::vector<Pose>& poses) {
  std::vector<Pose> kept;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i > 0 && i + 1 < poses.size() && poses[i].yaw == kept.back().yaw && poses[i].yaw == poses[i + 1].yaw) {
      const Eigen::Vector2d before = poses[i].p - kept.back().p, after = poses[i + 1].p - poses[i].p;
      if (before.dot(after) > 0 && std::abs(before.x() * after.y() - before.y() * after.x()) < 1e-9 * after.norm())
        continue;
    }
    kept.push_back(poses[i]);
  }
  return kept;
}

}  // namespace

PoseSearch::PoseSearch(const OpenGrid& grid, const Footprint& footprint, double turn_radius, const ExtraCosts* extra)
    : grid_(grid),
      extra_(extra),
      field_(grid, reach_for(footprint)),
      room_(grid, field_, footprint),
      cost_(room_, extra),
      steering_(turn_radius) {
  const Window all{{0, 0}, {grid.width() - 1, grid.height() - 1}};
  OpenGrid possible(grid.width(), grid.height());
  open_cells(possible, all);
  ways_ = std::make_unique<GridPaths>(std::move(possible), margin_for(footprint));
  ways_->prepare_clear();
  take_extra(all);
}

void PoseSearch::take_extra(const Window& window) {
  if (extra_ == nullptr || !extra_->has_any()) return;
  for (int y = window.low.y; y <= window.high.y; ++y) {
    for (int x = window.low.x; x <= window.high.x; ++x) (void)ways_->set_extra({x, y}, extra_->at({x, y}));
  }
}

void PoseSearch::open_cells(OpenGrid& to, const Window& window) const {
  // From anywhere in a cell to the nearest blocked square it is at most the distance of their centres, less half a
  // cell, and half a diagonal more.
  const double needed =
      std::clamp(room_.footprint().inscribed() - kFootprintTouch - 0.2072, 0.5, static_cast<double>(field_.reach()));
  for (int y = window.low.y; y <= window.high.y; ++y) {
    const std::uint16_t* row = field_.row(y);
    for (int x = window.low.x; x <= window.high.x; ++x) to.set({x, y}, row[x] >= needed * needed);
  }
}

void PoseSearch::update(const Window& window) {
  field_.update(window);
  const int reach = field_.reach();
  const Window wide{
      {std::max(0, window.low.x - reach), std::max(0, window.low.y - reach)},
      {std::min(grid_.width() - 1, window.high.x + reach), std::min(grid_.height() - 1, window.high.y + reach)}};
  ways_->update(wide, [&](OpenGrid& ways) { open_cells(ways, wide); });
  take_extra(window);
}

std::optional<std::vector<Cell>> PoseSearch::grid_path(Cell start, Cell goal, const PoseEffort& effort) {
  ClearanceSearch::Limits limits;
  limits.expanded = effort.cells;
  auto path = ways_->clear(start, goal, limits);
  if (!path) return std::nullopt;
  // The disc gets through where the footprint does not, whatever its yaw: such places are closed for this request.
  constexpr int kAround = 4;
  std::vector<Window> closed;
  for (int i = 0; i < kMostDetours && !effort.stop(); ++i) {
    const auto narrow = first_too_narrow(room_, path->cells, room_.footprint().circumscribed());
    if (!narrow) break;
    const Window window{
        {std::max(0, narrow->x - kAround), std::max(0, narrow->y - kAround)},
        {std::min(grid_.width() - 1, narrow->x + kAround), std::min(grid_.height() - 1, narrow->y + kAround)}};
    closed.push_back(window);
    const std::uint16_t least = field_.squared(*narrow);
    ways_->update(window, [&](OpenGrid& ways) {
      for (int y = window.low.y; y <= window.high.y; ++y) {
        for (int x = window.low.x; x <= window.high.x; ++x) {
          if (field_.squared({x, y}) <= least) ways.set({x, y}, false);
        }
      }
    });
    auto detour = ways_->clear(start, goal, limits);
    if (!detour) break;
    limits.expanded -= detour->expanded;
    path = std::move(detour);
  }
  for (const Window& window : closed) {
    ways_->update(window, [&](OpenGrid& ways) { open_cells(ways, window); });
  }
  return std::move(path->cells);
}

SampleRegion PoseSearch::anywhere(Cell from) {
  SampleRegion region;
  region.spread = 1;
  // Every other cell in both directions is close enough.
  for (int y = 0; y < grid_.height(); y += 2) {
    for (int x = 0; x < grid_.width(); x += 2) {
      if (ways_->grid().is_open({x, y}) && ways_->connected(from, {x, y})) region.cells.push_back({x, y});
    }
  }
  return region;
}

FoundMotions PoseSearch::search(const std::vector<Cell>& cells, const Pose& start, const Pose& goal,
                                const PoseEffort& effort, PoseRoute& route) {
  const auto is_over = [&](const FoundMotions& found, PoseMeans means) {
    route.steps += found.steps;
    if (!found.motions.empty()) route.means = means;
    return found.stopped || !found.motions.empty();
  };
  for (const GuideDensity& density : kDensities) {
    const Guide guide = make_guide(room_, cells, start, goal, density);
    FoundMotions found = search_along(guide, room_, steering_, cost_, {effort.guided, effort.stop});
    if (is_over(found, PoseMeans::kGuided)) return found;
  }
  const SampleRegion corridor{cells, 2 * room_.footprint().circumscribed()};
  FoundMotions found =
      search_by_samples(corridor, start, goal, room_, steering_, {effort.corridor, effort.stop}, kSeed);
  if (is_over(found, PoseMeans::kCorridor)) return found;
  found =
      search_by_samples(anywhere(cells.front()), start, goal, room_, steering_, {effort.anywhere, effort.stop}, kSeed);
  if (is_over(found, PoseMeans::kAnywhere)) return found;
  return {};
}

PoseRoute PoseSearch::find(const Pose& start, const Pose& goal, const PoseEffort& effort) {
  PoseRoute route;
  const auto is_on = [&](const Pose& pose) {
    return pose.is_finite() && pose.p.minCoeff() >= 0 && pose.p.x() < grid_.width() && pose.p.y() < grid_.height();
  };
  if (!is_on(start) || !room_.stands(start)) return {PoseOutcome::kStartBlocked, PoseMeans::kNone, {}, 0, 0};
  if (!is_on(goal) || !room_.stands(goal)) return {PoseOutcome::kGoalBlocked, PoseMeans::kNone, {}, 0, 0};
  if (!ways_->connected(cell_of(start.p), cell_of(goal.p))) return {PoseOutcome::kNoWay, PoseMeans::kNone, {}, 0, 0};
  const auto cells = grid_path(cell_of(start.p), cell_of(goal.p), effort);
  if (!cells) return route;
  FoundMotions found = search(*cells, start, goal, effort, route);
  if (!found.stopped && found.motions.empty()) return route;
  if (!found.stopped) found = shorten(found.motions, room_, steering_, cost_, {effort.shortening, effort.stop});
  if (found.stopped) {
    route.outcome = PoseOutcome::kStopped;
    return route;
  }
  route.outcome = PoseOutcome::kFound;
  route.poses.push_back(start);
  for (const Motion& motion : found.motions) {
    append_poses(room_, motion, route.poses);
    route.length += motion.length();
  }
  route.poses = without_flat(route.poses);
  return route;
}

}  // namespace concord
