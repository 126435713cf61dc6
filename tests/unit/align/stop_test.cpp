#include <gtest/gtest.h>

#include <functional>

#include "align/align_task.hpp"
#include "align/column_search.hpp"
#include "align/height_search.hpp"
#include "align/hypotheses.hpp"
#include "align/looseness.hpp"
#include "align/moved_things.hpp"
#include "align/prepare.hpp"
#include "align/wall_grid.hpp"
#include "align/workers.hpp"
#include "core/compose.hpp"
#include "core/resample.hpp"
#include "rooms.hpp"

// Nobody waits any longer: whatever stage it is at, it ends at its first look.

namespace concord::test {
namespace {

const Eigen::Matrix3d kUpright = Eigen::Matrix3d::Identity();
const Transform kThere = transform(0.05, 0.05, 0.0, 0.02);

struct Maps {
  Points points = test::room();
  BrickMap voxels = voxels_of(points);
  AlignMap room = cloud_map(points);
  AlignMap other = cloud_map(other_room());
};
const Maps& maps() {
  static const Maps kMaps;
  return kMaps;
}

using Work = std::function<void()>;

bool ends_at_once(const Work& work) {
  std::stop_source stop;
  stop.request_stop();
  const StopScope scope(stop.get_token());
  try {
    work();
  } catch (const Stopped&) {
    return true;
  }
  return false;
}

/// What takes long and is done on one thread: a stop is heard within each, not only in what comes next.
TEST(Stop, EveryStageOfAlignmentHearsIt) {
  const Maps& m = maps();
  const std::vector<std::pair<std::string, Work>> stages{
      {"surface of voxels", [&] { (void)surface_points(m.voxels, kResolution); }},
      {"surface of a cloud", [&] { (void)surface_points(std::span<const Eigen::Vector3f>(m.points)); }},
      {"scattered", [&] { (void)are_scattered(Points(kMaxSurfaceBlocks + 1), kResolution); }},
      {"loners", [&] { (void)without_loners(m.points, kResolution, 1); }},
      {"level", [&] { SurfaceLevel(m.points, 0.1, 1); }},
      {"coarser level", [&] { SurfaceLevel(m.room.fine(), 0.25, 1); }},
      {"strays", [&] { (void)m.room.fine().without_strays(m.points, 1); }},
      {"known free space", [&] { (void)ObservedFreeSpace::known(m.voxels, kResolution); }},
      {"implied free space", [&] { (void)ObservedFreeSpace::implied(m.room.fine(), 1); }},
      {"columns of free space", [&] { (void)m.room.free.columns(); }},
      {"mirrored free space", [&] { (void)m.room.free.mirrored(); }},
      {"upright", [&] { (void)upright(m.room.fine()); }},
      {"sides", [level = m.room.fine()]() mutable { level.orient([](const auto&) { return false; }); }},
      {"wall columns", [&] { (void)wall_columns(m.room, kUpright, 0.1); }},
      {"columns", [&] { (void)search_columns(m.room, kUpright, m.room, kUpright, {}, 1); }},
      {"heights", [&] { (void)search_heights(m.room, kUpright, m.room, kUpright, kThere, -2.0, 2.0); }},
      {"refinement", [&] { (void)refine_fully(m.room, m.room, kThere, 1); }},
      {"fine refinement", [&] { (void)refine_finely(m.room, m.room, kThere, 1); }},
      {"hypotheses", [&] { (void)find_hypotheses(m.room, m.room, around_guess(kThere), 1); }},
      {"evidence", [&] { (void)support(m.room, m.room, kThere, 1000, 1); }},
      {"against", [&] { (void)pieces_against(m.room, m.other, kThere, 1000); }},
      {"looseness", [&] { (void)loose_directions(m.room, m.room, kThere, 1); }},
      {"mirror image", [&] { (void)mirrored(m.room, 1); }},
      {"preparation", [&] { (void)prepare_map(m.voxels, kResolution, 1); }},
      {"alignment", [&] { (void)align(m.room, m.room, kThere, 1); }},
      {"alignment from anywhere", [&] { (void)align(m.room, m.room, std::nullopt, 2); }},
      {"recheck", [&] { (void)recheck(m.room, m.room, kThere, 1); }},
  };
  for (const auto& [name, work] : stages) EXPECT_TRUE(ends_at_once(work)) << name;
}

TEST(Stop, IsHeardWithinAChunkOnWhateverThread) {
  for (const int threads : {1, 2}) {
    std::stop_source stop;
    const StopScope scope(stop.get_token());
    std::atomic<int> began = 0;
    std::atomic<int> ended = 0;
    const auto work = [&](std::size_t) {
      ++began;
      stop.request_stop();
      look_for_stop();
      ++ended;
    };
    EXPECT_THROW(for_each_chunk(threads, 8, work), Stopped);
    EXPECT_GE(began, 1);
    EXPECT_EQ(ended, 0);
  }
  look_for_stop();  // nobody asks any longer
}

TEST(Stop, OfManyShortStepsEachThousandthLooks) {
  std::stop_source stop;
  const StopScope scope(stop.get_token());
  StopLook look;
  look.step();
  stop.request_stop();
  int steps = 0;
  const auto go_on = [&] {
    for (; steps < 10'000; ++steps) look.step();
  };
  EXPECT_THROW(go_on(), Stopped);
  EXPECT_LE(steps, 1024);
}

TEST(Stop, EndsMergingAndResampling) {
  std::stop_source stop;
  stop.request_stop();
  const Layer layer{&maps().voxels, kThere, 1};
  EXPECT_TRUE(compose(std::span(&layer, 1), {}, Policy::kMean, kResolution, 2, stop.get_token()).values.empty());
  EXPECT_TRUE(resample(maps().voxels, kResolution, 0.1, 1'000'000, stop.get_token())->empty());
}

/// Among what contradicts a place the middle of a thing is looked for at thousands of places.
TEST(Stop, IsHeardWhileMovedThingsAreLookedFor) {
  std::stop_source stop;
  const StopScope scope(stop.get_token());
  const auto remember = [&] {
    const Support found = support(maps().room, maps().other, kThere, 4000, 1);
    stop.request_stop();
    (void)without_moved_things(maps().room, maps().other, kThere, found, 4000, {0.75, 2.0}, 2);
  };
  EXPECT_THROW(remember(), Stopped);
}

}  // namespace
}  // namespace concord::test
