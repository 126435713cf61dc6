#include "align_speed.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>

#include "align/hypotheses.hpp"

namespace concord::bench {
namespace {

constexpr double kResolution = 0.1;

/// Of this thread: an OpenMP peer's other threads spin on for a while after their work.
double processor_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

double wall_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

AlignMap surfaces_of(const Points& points, int threads) {
  AlignMap map;
  map.resolution = kResolution;
  map.points = points;
  map.levels = make_levels(map.points, kResolution, threads);
  return map;
}

Transform refine_alone(const Points& target, const Points& source, const Transform& guess, int threads) {
  return refine_fully(surfaces_of(target, threads), surfaces_of(source, threads), guess, threads).T_target_source;
}

Transform align_whole(const Points& target, const Points& source, const Transform& guess, int threads) {
  return align(make_align_map(target, kResolution, threads).value(),
               make_align_map(source, kResolution, threads).value(), guess, threads)
      .T_target_source;
}

}  // namespace

std::vector<Timing> race(const Pair& pair, const Transform& guess, const std::vector<Method>& methods,
                         const std::vector<int>& threads, int rounds) {
  std::vector<Timing> out;
  for (const Method& method : methods) {
    for (const int count : threads) out.push_back({method.name, count, 1e300, {}});
  }
  for (int round = 0; round < rounds; ++round) {
    std::size_t next = 0;
    for (const Method& method : methods) {
      for (const int count : threads) {
        Timing& timing = out[next++];
        const auto now = count == 1 ? processor_ms : wall_ms;
        const double start = now();
        const Transform T = method.run(pair.target.points, pair.source.points, guess, count);
        timing.ms = std::min(timing.ms, now() - start);
        timing.miss = miss_of(pair, T);
      }
    }
  }
  return out;
}

std::vector<Method> our_methods() { return {{"concord refine", refine_alone}, {"concord align, whole", align_whole}}; }

#ifndef CONCORD_PEER_SMALL_GICP
std::vector<Method> peer_methods() { return {}; }
#endif

}  // namespace concord::bench
