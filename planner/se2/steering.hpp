#pragma once

#include <memory>
#include <optional>

#include "planner/se2/motion.hpp"

namespace concord {

/// The shortest way of a robot between two poses where nothing is in its way. With a turn radius as a car that can go
/// back: arcs of that radius and lines (Reeds & Shepp 1990, by OMPL). Without, it turns in place, goes straight, ahead
/// or back, and turns again. Not for several threads at once.
class Steering {
 public:
  /// Cells; 0: it turns in place. @pre finite, not negative.
  explicit Steering(double turn_radius);
  ~Steering();
  Steering(Steering&&) noexcept;
  Steering& operator=(Steering&&) noexcept;

  /// Nothing where rounding spoils it.
  [[nodiscard]] std::optional<Motion> connect(const Pose& from, const Pose& to) const;
  [[nodiscard]] double turn_radius() const { return turn_radius_; }

 private:
  struct ReedsShepp;

  double turn_radius_;
  std::unique_ptr<ReedsShepp> reeds_shepp_;  ///< none if it turns in place
};

}  // namespace concord
