#include "planner/footprint/standing_room.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "planner/footprint/hull_cells.hpp"

namespace concord {
namespace {

/// From a point of a cell to its centre, and from a square's nearest point to its.
constexpr double kHalfDiagonal = 0.70711;

Cell cell_of(const Eigen::Vector2d& p) {
  return {static_cast<std::int32_t>(std::floor(p.x())), static_cast<std::int32_t>(std::floor(p.y()))};
}

bool is_on(const OpenGrid& grid, const Eigen::Vector2d& p) {
  return p.x() >= 0 && p.y() >= 0 && p.x() < grid.width() && p.y() < grid.height();
}

}  // namespace

Pose Move::from(const Pose& start, double share) const {
  const double s = travel * share, w = turn * share;
  // Of an arc, the chord: half of the turn to its side.
  const double half = w / 2;
  const double chord = std::abs(half) < 1e-9 ? s : s * std::sin(half) / half;
  return {start.p + chord * Eigen::Vector2d(std::cos(start.yaw + half), std::sin(start.yaw + half)), start.yaw + w};
}

StandingRoom::StandingRoom(const OpenGrid& grid, const DistanceField& field, Footprint footprint)
    : grid_(grid), field_(field), footprint_(std::move(footprint)) {}

double StandingRoom::distance(const Eigen::Vector2d& p) const {
  return is_on(grid_, p) ? std::sqrt(field_.squared(cell_of(p))) : 0;
}

bool StandingRoom::stands(const Pose& pose) const {
  if (!is_on(grid_, pose.p)) return false;
  const double apart = distance(pose.p);
  if (apart - 2 * kHalfDiagonal >= footprint_.circumscribed()) return true;
  // Nothing blocked is nearer to its edge than the centre is, less half a cell, and it need not stand on the centre.
  if (apart < field_.reach() && apart + kHalfDiagonal - 0.5 < footprint_.inscribed() - kFootprintTouch) return false;
  return sweeps(pose, pose, 0);
}

int StandingRoom::steps(const Move& move) const {
  const double turn = std::abs(move.turn);
  const double travel = std::abs(move.travel);
  if (turn < 1e-12) return std::max(1, static_cast<int>(std::ceil(travel / kMostTravel)));
  // A point that far from the centre of the turn bows out of its chord by reach (1 - cos(step / 2)).
  const double reach = travel / turn + footprint_.circumscribed();
  const double step = std::min({kMostTurn, std::sqrt(8 * kBow / reach), turn * kMostTravel / std::max(travel, 1e-12)});
  return std::max(1, static_cast<int>(std::ceil(turn / step)));
}

bool StandingRoom::moves(const Pose& start, const Move& move) const {
  const int count = steps(move);
  const double travel = std::abs(move.travel) / count;
  const double slack = std::abs(move.turn) < 1e-12 ? 0 : kBow;
  Pose at = start;
  double clear = -1;  // so far may the reference point go on from `at` whatever the yaw
  for (int i = 1; i <= count; ++i) {
    const Pose next = move.from(start, static_cast<double>(i) / count);
    if (clear < travel) clear = distance(at.p) - 2 * kHalfDiagonal - footprint_.circumscribed();
    if (clear < travel && !sweeps(at, next, slack)) return false;
    clear -= travel;
    at = next;
  }
  return count > 0;
}

bool StandingRoom::sweeps(const Pose& from, const Pose& to, double slack) const {
  const double c0 = std::cos(from.yaw), s0 = std::sin(from.yaw), c1 = std::cos(to.yaw), s1 = std::sin(to.yaw);
  std::array<Eigen::Vector2d, 2 * Footprint::kMaxVertices> points;
  const bool is_one = from.p == to.p && from.yaw == to.yaw;
  return std::all_of(footprint_.parts().begin(), footprint_.parts().end(), [&](const auto& part) {
    std::size_t n = 0;
    for (const Eigen::Vector2d& v : part) {
      points[n++] = from.p + Eigen::Vector2d(c0 * v.x() - s0 * v.y(), s0 * v.x() + c0 * v.y());
      if (!is_one) points[n++] = to.p + Eigen::Vector2d(c1 * v.x() - s1 * v.y(), s1 * v.x() + c1 * v.y());
    }
    return covers_open_cells(grid_, {points.data(), n}, slack);
  });
}

}  // namespace concord
