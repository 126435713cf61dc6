#include "planner/scenario/scenario.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>

#include "planner/scenario/path_check.hpp"
#include "planner/scenario/textbook.hpp"
#include "planner/search/grid_paths.hpp"

namespace concord {
namespace {

constexpr double kEnough = 5e6;  ///< microseconds
constexpr double kLeast = 0.01;  ///< microseconds: below the clock's own resolution

double now_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e6 + static_cast<double>(now.tv_nsec) * 1e-3;
}

/// What it takes to read the clock: the median.
double clock_us() {
  std::array<double, 1001> times;
  for (double& time : times) {
    const double begin = now_us();
    time = now_us() - begin;
  }
  std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
  return times[times.size() / 2];
}

class Stopwatch {
 public:
  template <class Work>
  double time(Work work) const {
    const double begin = now_us();
    work();
    return std::max(now_us() - begin - clock_, kLeast);
  }

 private:
  double clock_ = clock_us();
};

double octile_length(std::int64_t cost) { return static_cast<double>(cost) / static_cast<double>(kStraight); }

void prepare(GridPaths& paths, Method method) {
  switch (method) {
    case Method::kFast: paths.prepare_fast(); break;
    case Method::kAnyAngle: paths.prepare_any_angle(); break;
    case Method::kClearance: paths.prepare_clear(); break;
  }
}

ScenarioPath ask(GridPaths& paths, Method method, const ScenarioQuery& query) {
  switch (method) {
    case Method::kFast:
      if (auto path = paths.fast(query.start, query.goal))
        return {true, octile_length(path->cost), std::move(path->turns)};
      break;
    case Method::kAnyAngle:
      if (auto path = paths.any_angle(query.start, query.goal)) return {true, path->length, std::move(path->turns)};
      break;
    case Method::kClearance:
      if (auto path = paths.clear(query.start, query.goal)) return {true, path->length, std::move(path->turns)};
      break;
  }
  return {};
}

/// Asks all; the median of what each took.
void time_all(GridPaths& paths, Method method, const std::vector<ScenarioQuery>& queries, int rounds,
              const Stopwatch& watch, ScenarioResult& result) {
  std::vector<std::vector<double>> took(queries.size());
  double spent = 0;
  for (int round = 0; round <= rounds && (round < 2 || spent < kEnough); ++round) {
    for (std::size_t i = 0; i < queries.size(); ++i) {
      ScenarioPath path;
      const double us = watch.time([&] { path = ask(paths, method, queries[i]); });
      spent += us;
      if (round == 0) result.paths.push_back(std::move(path));
      if (round > 0 || rounds == 0) took[i].push_back(us);
    }
  }
  for (std::vector<double>& times : took) {
    std::sort(times.begin(), times.end());
    result.us.push_back(times[times.size() / 2]);
  }
}

void judge(const OpenGrid& grid, const std::vector<ScenarioQuery>& queries, ScenarioResult& result) {
  double sum = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const ScenarioQuery& query = queries[i];
    const ScenarioPath& path = result.paths[i];
    if (!path.is_found) continue;
    ++result.solved;
    if (std::abs(path.length - query.optimum) <= query.rounding) ++result.optimal;
    if (path.turns.back() != query.goal) ++result.off_goal;
    if (path.turns.front() != query.start || !stays_in_open_cells(grid, path.turns)) ++result.invalid;
    const double ratio = query.optimum > 0 ? path.length / query.optimum : 1.0;
    sum += ratio;
    result.worst_ratio = std::max(result.worst_ratio, ratio);
  }
  if (result.solved > 0) result.mean_ratio = sum / static_cast<double>(result.solved);
}

void ask_textbook(const OpenGrid& grid, const std::vector<ScenarioQuery>& queries, std::size_t count,
                  const Stopwatch& watch, ScenarioResult& result) {
  if (queries.empty() || count == 0) return;
  TextbookAStar textbook(grid);
  const std::size_t stride = (queries.size() + count - 1) / count;
  for (std::size_t i = 0; i < queries.size(); i += stride) {
    std::optional<std::int64_t> cost;
    result.sample.push_back(i);
    result.textbook_us.push_back(watch.time([&] { cost = textbook.find(queries[i].start, queries[i].goal); }));
    const bool same = cost && std::abs(octile_length(*cost) - queries[i].optimum) <= queries[i].rounding;
    if (!same) ++result.textbook_differs;
  }
}

}  // namespace

double ScenarioResult::us_at(double share) const {
  if (us.empty()) return 0;
  std::vector<double> sorted = us;
  std::sort(sorted.begin(), sorted.end());
  return sorted[std::min(static_cast<std::size_t>(share * static_cast<double>(sorted.size())), sorted.size() - 1)];
}

double ScenarioResult::speedup_textbook() const {
  if (sample.empty()) return 0;
  double sum = 0;
  for (std::size_t i = 0; i < sample.size(); ++i) sum += std::log(textbook_us[i] / us[sample[i]]);
  return std::exp(sum / static_cast<double>(sample.size()));
}

ScenarioResult run_scenario(const OpenGrid& grid, const std::vector<ScenarioQuery>& queries, Method method,
                            const ScenarioEffort& effort) {
  const Stopwatch watch;
  ScenarioResult result;
  GridPaths paths(grid);
  result.prep_ms = watch.time([&] { prepare(paths, method); }) / 1e3;
  time_all(paths, method, queries, effort.rounds, watch, result);
  judge(grid, queries, result);
  ask_textbook(grid, queries, effort.textbook, watch, result);
  return result;
}

}  // namespace concord
