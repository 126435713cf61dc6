#pragma once

#include <cstddef>
#include <vector>

#include "planner/files/movingai.hpp"
#include "planner/lattice/open_grid.hpp"

namespace concord {

/// What is searched for: see GridPaths.
enum class Method { kFast, kAnyAngle, kClearance };

struct ScenarioPath {
  bool is_found = false;
  double length = 0;  ///< cells
  std::vector<Cell> turns;
};

/// Times are processor time of this thread in microseconds, without what reading the clock takes.
struct ScenarioResult {
  std::vector<ScenarioPath> paths;  ///< by query
  std::vector<double> us;           ///< by query
  double prep_ms = 0;               ///< what is worked out of the grid alone
  std::size_t solved = 0;
  std::size_t optimal = 0;                 ///< as long as the optimum, as far as that is given
  std::size_t off_goal = 0;                ///< solved, but with another end than the goal
  std::size_t invalid = 0;                 ///< touch what is blocked, or begin elsewhere
  double worst_ratio = 0, mean_ratio = 0;  ///< length over the optimum, of the solved
  std::vector<std::size_t> sample;         ///< queries that the textbook search was asked, too
  std::vector<double> textbook_us;         ///< by sample
  std::size_t textbook_differs = 0;        ///< of these, whose lengths are not the same as the optimum that was given

  [[nodiscard]] double us_at(double share) const;
  /// Geometric mean over the sample; 0 where there is none.
  [[nodiscard]] double speedup_textbook() const;
};

struct ScenarioEffort {
  int rounds = 3;            ///< in which times are taken, after one to warm up; 0: that one's times count
  std::size_t textbook = 0;  ///< queries, spread evenly, that are asked of TextbookAStar, too
};

/// Asks every query in each round; the median of its times counts. A method that has taken five seconds is asked once
/// more at most.
[[nodiscard]] ScenarioResult run_scenario(const OpenGrid& grid, const std::vector<ScenarioQuery>& queries,
                                          Method method, const ScenarioEffort& effort);

}  // namespace concord
