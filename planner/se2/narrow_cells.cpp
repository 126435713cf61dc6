#include "planner/se2/narrow_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace concord {
namespace {

constexpr int kYaws = 64;
const std::array kBeside{Eigen::Vector2d(0, 0),      Eigen::Vector2d(0, 0.5),  Eigen::Vector2d(0, -0.5),
                         Eigen::Vector2d(0.5, 0),    Eigen::Vector2d(-0.5, 0), Eigen::Vector2d(0.5, 0.5),
                         Eigen::Vector2d(-0.5, -0.5)};

/// The likeliest yaw first.
bool has_room(const StandingRoom& room, Cell cell, double likely) {
  const Eigen::Vector2d centre(cell.x + 0.5, cell.y + 0.5);
  if (room.stands({centre, likely})) return true;
  return std::any_of(kBeside.begin(), kBeside.end(), [&](const Eigen::Vector2d& beside) {
    for (int i = 0; i < kYaws; ++i) {
      if (room.stands({centre + beside, 2 * M_PI * i / kYaws})) return true;
    }
    return false;
  });
}

double apart(Cell a, Cell b) { return std::hypot(a.x - b.x, a.y - b.y); }

}  // namespace

std::optional<Cell> first_too_narrow(const StandingRoom& room, const std::vector<Cell>& cells, double near) {
  constexpr std::size_t kAround = 4;  // cells before and after tell which way the path goes
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (apart(cells[i], cells.front()) <= near || apart(cells[i], cells.back()) <= near) continue;
    const Cell a = cells[i > kAround ? i - kAround : 0];
    const Cell b = cells[std::min(i + kAround, cells.size() - 1)];
    if (!has_room(room, cells[i], std::atan2(b.y - a.y, b.x - a.x))) return cells[i];
  }
  return std::nullopt;
}

}  // namespace concord
