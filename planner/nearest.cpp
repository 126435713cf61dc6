#include "planner/nearest.hpp"

#include <algorithm>
#include <cmath>

namespace concord {
namespace {

/// Looks through rows outwards from the goal; cells of one run hang together, so one of them is asked about.
class Outwards {
 public:
  Outwards(GridPaths& paths, Cell start, const Eigen::Vector2d& goal) : paths_(paths), start_(start), goal_(goal) {}

  std::optional<Cell> run() {
    const int height = paths_.grid().height();
    const auto middle = static_cast<int>(std::clamp(std::floor(goal_.y()), 0.0, height - 1.0));
    for (int away = 0; away < height; ++away) {
      const double gap = std::min(std::abs(middle + away + 0.5 - goal_.y()), std::abs(middle - away + 0.5 - goal_.y()));
      if (best_ && gap * gap > least_) break;
      if (middle - away >= 0) row(middle - away);
      if (away > 0 && middle + away < height) row(middle + away);
    }
    return best_;
  }

 private:
  void row(int y) {
    const OpenGrid& grid = paths_.grid();
    for (int x = 0; x < grid.width();) {
      const std::uint64_t word = grid.row_from({x, y});
      if (word == 0) {
        x += 64;
        continue;
      }
      x += std::countr_zero(word);
      if (x >= grid.width()) return;
      int last = x;
      while (last + 1 < grid.width() && grid.is_open({last + 1, y})) ++last;
      const Cell cell{static_cast<std::int32_t>(std::clamp<double>(std::floor(goal_.x()), x, last)), y};
      const double squared = (centre_of(cell) - goal_).squaredNorm();
      if ((!best_ || squared < least_) && paths_.connected(start_, cell)) {
        best_ = cell;
        least_ = squared;
      }
      x = last + 1;
    }
  }

  GridPaths& paths_;
  Cell start_;
  Eigen::Vector2d goal_;
  std::optional<Cell> best_;
  double least_ = 0;
};

}  // namespace

std::optional<Eigen::Vector2d> nearest_reachable(const RobotTask& task, const Eigen::Vector2d& from,
                                                 const Eigen::Vector2d& to) {
  const double r = task.terrain().resolution();
  const auto area = task.grids.areas().around(cell_of(from / r));
  const auto grid = area ? task.grids.at(task.in_cells(), Ignoring::kNothing, *area) : nullptr;
  if (grid == nullptr) return std::nullopt;
  const std::vector<Cell> starts = anchors(grid->space(), from / r);
  if (starts.empty()) return std::nullopt;
  const Eigen::Vector2d corner(grid->area().low.x, grid->area().low.y);
  const auto cell = Outwards(grid->paths(), grid->local(starts.front()), to / r - corner).run();
  return cell ? std::optional<Eigen::Vector2d>(centre_of(grid->global(*cell)) * r) : std::nullopt;
}

}  // namespace concord
