#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/requests.hpp"

namespace concord {

/// A robot that goes where the planner says: along its kept path as it was last said, and nowhere while there is none.
/// What the planner does not stand by any more, be it that its validator refused it, stops the robot.
class PathFollower {
 public:
  /// A kept path is said each second: who hears nothing for so long stops, microseconds.
  static constexpr std::int64_t kPatience = 3'000'000;
  /// A path that is further away is not this robot's to follow, metres.
  static constexpr double kBeside = 1.0;

  struct Place {
    Eigen::Vector2d p;  ///< map frame, metres
    double yaw = 0;
  };

  PathFollower(const Place& place, double speed) : place_(place), speed_(speed) {}

  /// What was said of this robot's path. Answers to questions and other frames' paths are not heeded.
  void hear(const Path& path, std::int64_t now);
  /// Goes on for so long, at most to `free` metres ahead. Returns whether it moved.
  bool go(double seconds, double free, std::int64_t now);

  [[nodiscard]] const Place& place() const { return place_; }
  /// Where it would go on to.
  [[nodiscard]] double heading() const;
  [[nodiscard]] double driven() const { return driven_; }
  /// A path that it was on ended before the goal.
  [[nodiscard]] int stops() const { return stops_; }
  [[nodiscard]] bool has_way() const { return along_ < length_; }

 private:
  void stop();
  struct Step {
    Place place;
    double heading;  ///< of the way there: one with a footprint may go backwards
  };
  [[nodiscard]] Step at(double along) const;

  Place place_;
  double speed_;
  std::string request_;
  std::int64_t path_id_ = 0, heard_ = 0;
  std::vector<Eigen::Vector2d> points_;
  std::vector<double> yaws_;  ///< at each, of a path for a footprint; turns in place take no time
  std::vector<double> sums_;  ///< metres along to each
  double along_ = 0, length_ = 0, driven_ = 0;
  int stops_ = 0;
};

}  // namespace concord
