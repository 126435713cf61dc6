#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/error.hpp"

namespace concord {

/// A robot's outline seen from above, in its own frame: x ahead, y to the left, its reference point at the origin. A
/// simple polygon that holds the origin; what is inside counts, not the line alone.
class Footprint {
 public:
  static constexpr std::size_t kMaxVertices = 64;
  static constexpr double kMaxReach = 10.0;  ///< of a vertex, metres
  static constexpr double kLeast = 0.001;    ///< between the origin and the outline, metres

  /// Counter-clockwise.
  [[nodiscard]] const std::vector<Eigen::Vector2d>& polygon() const { return polygon_; }
  /// Convex polygons, counter-clockwise, that make it up: itself if it is convex, else triangles.
  [[nodiscard]] const std::vector<std::vector<Eigen::Vector2d>>& parts() const { return parts_; }
  /// Of the largest disc around the origin that lies in it, and of the smallest that holds it.
  [[nodiscard]] double inscribed() const { return inscribed_; }
  [[nodiscard]] double circumscribed() const { return circumscribed_; }

  /// The same in other units, so many to a metre. @pre factor > 0.
  [[nodiscard]] Footprint scaled(double factor) const;

  /// Metres. Refused: under 3 or over kMaxVertices corners (kMalformed, kTooLarge), numbers that are none (kNotFinite),
  /// a corner further away than kMaxReach (kOutOfBounds), an outline that touches or crosses itself, or does not hold
  /// the origin kLeast inside (kBadShape).
  [[nodiscard]] static Result<Footprint> make(std::vector<Eigen::Vector2d> polygon);

 private:
  Footprint() = default;

  std::vector<Eigen::Vector2d> polygon_;
  std::vector<std::vector<Eigen::Vector2d>> parts_;
  double inscribed_ = 0, circumscribed_ = 0;
};

/// `length` along x, `width` along y, the origin in its middle. Refused: see Footprint::make.
[[nodiscard]] Result<Footprint> make_rectangle(double length, double width);

}  // namespace concord
