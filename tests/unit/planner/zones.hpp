#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <Eigen/Geometry>

#include "core/corrections.hpp"

namespace concord::test {

inline Zone box_zone(const std::string& name, Zone::Kind kind, Eigen::Vector3d min, Eigen::Vector3d max) {
  Zone zone;
  zone.name = name;
  zone.kind = kind;
  zone.volume = Box{min, max};
  return zone;
}
/// From the floor to 2 m.
inline Zone no_go(const std::string& name, Eigen::Vector2d min, Eigen::Vector2d max) {
  return box_zone(name, Zone::Kind::kNoGo, {min.x(), min.y(), 0}, {max.x(), max.y(), 2});
}
inline Zone contact(const std::string& name, Eigen::Vector2d min, Eigen::Vector2d max) {
  return box_zone(name, Zone::Kind::kAllowContact, {min.x(), min.y(), 0}, {max.x(), max.y(), 2});
}

inline Zone costly(const std::string& name, Eigen::Vector2d min, Eigen::Vector2d max, int cost, double margin = 0) {
  Zone zone = no_go(name, min, max);
  zone.kind = Zone::Kind::kCostly;
  zone.cost = cost;
  zone.margin = margin;
  return zone;
}

inline Zone corridor(const std::string& name, Eigen::Vector2d min, Eigen::Vector2d max) {
  Zone zone = no_go(name, min, max);
  zone.kind = Zone::Kind::kCorridor;
  return zone;
}

/// Any kind, shape, place and tilt, within a field of `width` by `height` metres; some lie above or below the floor.
inline Zone random_zone(std::mt19937& random, const std::string& name, double width, double height, double size) {
  std::uniform_real_distribution<double> share(0, 1);
  Zone zone;
  zone.name = name;
  zone.kind = random() % 2 == 0 ? Zone::Kind::kNoGo : Zone::Kind::kAllowContact;
  const Eigen::Vector3d extent = Eigen::Vector3d(share(random), share(random), share(random)) * size;
  zone.T_map_zone.translation() = Eigen::Vector3d(share(random) * width, share(random) * height, 4 * share(random) - 2);
  if (random() % 2 == 0) {
    zone.T_map_zone.linear() =
        Eigen::AngleAxisd(share(random) * 6.3, Eigen::Vector3d(share(random) - 0.5, share(random), 1).normalized())
            .toRotationMatrix();
  }
  switch (random() % 3) {
    case 0: zone.volume = Box{-extent, extent}; break;
    case 1: {
      OrientedBox box;
      box.T_frame_box.linear() = Eigen::AngleAxisd(share(random), Eigen::Vector3d::UnitZ()).toRotationMatrix();
      box.size = extent;
      zone.volume = box;
      break;
    }
    default: {
      Prism star;  // every second corner is drawn in
      for (int i = 0; i < 6; ++i) {
        const double angle = i * std::numbers::pi / 3;
        star.points.emplace_back(Eigen::Vector2d(std::cos(angle), std::sin(angle)) * size * (i % 2 == 0 ? 0.9 : 0.3));
      }
      star.low = -extent.z();
      star.high = extent.z();
      zone.volume = star;
    }
  }
  return zone;
}

}  // namespace concord::test
