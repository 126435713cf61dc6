#pragma once

#include <string>

#include "cli/command.hpp"
#include "cli/plan_ground.hpp"

namespace concord {

struct FootprintOptions {
  std::string from, to;    ///< "x y yaw"
  std::string footprint;   ///< see read_footprint
  double turn_radius = 0;  ///< metres
  std::string paths;       ///< to write, a JSON object in a line; empty: none
  std::string picture;     ///< to write; empty: none
  std::string map;         ///< named in the picture
  double cut = 0;          ///< height of the picture's section, metres
};

/// `concord plan --footprint ...` on a file: a path with the footprint's clearance, or the reason why there is none.
[[nodiscard]] Outcome plan_footprint(const FootprintOptions& options, const Ground2D& ground, const Common& common);

}  // namespace concord
