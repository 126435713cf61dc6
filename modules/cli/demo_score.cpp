#include "cli/demo_score.hpp"

#include <algorithm>
#include <span>
#include <thread>

#include "core/compose.hpp"

namespace concord {
namespace {

int threads() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

template <class Reached>
std::optional<double> first_that(const std::vector<MappingMoment>& moments, double MappingMoment::*seconds,
                                 Reached reached) {
  const auto first =
      std::ranges::partition_point(moments, [&](const MappingMoment& moment) { return !reached(moment); });
  return first == moments.end() ? std::nullopt : std::optional(*first.*seconds);
}

}  // namespace

BrickMap occupied_part(const BrickMap& map) {
  BrickMap part;
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    DenseBrick values;
    values.fill(kUnknown);
    bool any = false;
    brick.for_each([&](int local, LogOdds value) {
      if (!is_occupied(value)) return;
      values[local] = value;
      any = true;
    });
    if (any) part.set(index, Brick::from_dense(values));
  });
  return part;
}

DemoScorer::DemoScorer(const World& world, double resolution, Transform T_map_robot)
    : resolution_(resolution), T_map_robot_(std::move(T_map_robot)), truth_(make_truth(world, resolution)) {}

MapScore DemoScorer::alone(const BrickMap& submap, const Transform& T_map_agent) const {
  const Layer layer{&submap, T_map_agent, 1};
  return score(compose(std::span(&layer, 1), {}, Policy::kMean, resolution_, threads()).values, truth_);
}

std::optional<double> DemoScorer::merged_reached(const std::vector<MappingMoment>& moments, double recall) const {
  return first_that(moments, &MappingMoment::seconds,
                    [&](const MappingMoment& moment) { return merged(moment.merged).recall >= recall; });
}

std::optional<double> DemoScorer::robot_reached(const std::vector<MappingMoment>& moments, double recall) const {
  return first_that(moments, &MappingMoment::robot_seconds,
                    [&](const MappingMoment& moment) { return robot(moment.robot).recall >= recall; });
}

}  // namespace concord
