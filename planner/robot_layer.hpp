#pragma once

#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "planner/zone_cells.hpp"

namespace concord {

/// Where robots stand, as cells beside the grid: obstacles to each other, never to themselves. All in cells.
class RobotLayer {
 public:
  /// The robot's disc covers `p` and all within `radius`, until it is said anew. It is taken somewhat larger, and
  /// changes only when the robot has moved by what it is larger. Returns the columns of bricks that changed.
  std::vector<BrickIndex> set(const std::string& robot, const Eigen::Vector2d& p, double radius);
  /// It is nowhere. Returns the columns that it stood in.
  std::vector<BrickIndex> remove(const std::string& robot);

  /// This robot alone is no obstacle from now on; empty: none. Returns the columns that changed.
  std::vector<BrickIndex> leave_out(const std::string& robot);
  [[nodiscard]] const std::string& left_out() const { return left_out_; }

  /// Cells of a column of bricks that a robot stands in; bit x + 8 y.
  [[nodiscard]] std::uint64_t at(BrickIndex column) const;
  [[nodiscard]] bool empty() const { return standing_.empty(); }
  /// The first robot, by name, that stands within `reach` of `p`; empty: none does.
  [[nodiscard]] std::string robot_near(const Eigen::Vector2d& p, double reach) const;
  [[nodiscard]] std::vector<std::string> robots() const;

 private:
  struct Standing {
    Eigen::Vector2d p;
    double radius, slack;
    std::vector<ColumnPlane> cells;
  };
  [[nodiscard]] static std::vector<BrickIndex> columns_of(const std::vector<ColumnPlane>& cells);
  void take_away(const std::string& robot, const Standing& standing);

  std::map<std::string, Standing> standing_;
  /// Who stands there, and where.
  std::unordered_map<BrickIndex, std::map<std::string, std::uint64_t>, IndexHash> columns_;
  std::string left_out_;
};

[[nodiscard]] const RobotLayer& no_robots();

}  // namespace concord
