#pragma once

#include <functional>
#include <string>
#include <vector>

#include "align_cases.hpp"

namespace concord::bench {

using Points = std::vector<Eigen::Vector3f>;

/// One way to refine a guess, from plain points to the transform: all that it needs to prepare counts.
struct Method {
  std::string name;
  std::function<Transform(const Points& target, const Points& source, const Transform& guess, int threads)> run;
};

struct Timing {
  std::string method;
  int threads = 1;
  double ms = 0.0;  ///< one thread: processor time; more: wall clock; the least of the rounds
  Miss miss;
};

/// The same points and the same guess for every method, in turns.
[[nodiscard]] std::vector<Timing> race(const Pair& pair, const Transform& guess, const std::vector<Method>& methods,
                                       const std::vector<int>& threads, int rounds);

[[nodiscard]] std::vector<Method> our_methods();
[[nodiscard]] std::vector<Method> pcl_methods();
/// Of small_gicp, where one is installed (CMake: -DCONCORD_PEER_SMALL_GICP=prefix); else none.
[[nodiscard]] std::vector<Method> peer_methods();

}  // namespace concord::bench
