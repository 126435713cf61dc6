#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "planner/pose_plan.hpp"

namespace concord {

/// The pose planners that were asked for of late, one for each robot: to each the others are obstacles.
class PosePlanners {
 public:
  static constexpr std::size_t kMaxKept = 256;
  /// Of all that are kept, beyond the last.
  static constexpr std::int64_t kMaxKeptCells = 24'000'000;

  explicit PosePlanners(const Terrain& terrain) : terrain_(terrain) {}

  /// To be asked only while the terrain is as this robot sees it.
  [[nodiscard]] std::shared_ptr<PosePlanner> at(const std::string& robot, const Body& body);
  void follow(std::span<const BrickIndex> columns);
  /// Anything may have changed.
  void clear();
  /// Cells that they have laid out so far: what it took.
  [[nodiscard]] std::int64_t made() const;

 private:
  struct Kept {
    std::string robot;
    std::shared_ptr<PosePlanner> planner;
  };

  Terrain terrain_;
  std::vector<Kept> kept_;  ///< the last that was asked for comes last
  std::int64_t made_ = 0;   ///< by those that are not kept any longer
};

}  // namespace concord
