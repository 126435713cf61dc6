#include "merge_figures.hpp"

#include <algorithm>
#include <ctime>

#include "core/compose.hpp"
#include "papers_merge.hpp"

namespace concord::bench {
namespace {

constexpr int kRounds = 3;         // each: the papers' loop once, then ours several times
constexpr int kFullsPerRound = 5;  // of ours
constexpr int kRegions = 16;       // places that change, so that caches hold no more than in life
constexpr double kChangedShare = 0.01;

/// Processor time of this thread: what else the machine does counts for neither side.
double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

template <class Work>
double seconds(Work&& work) {
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

std::vector<Layer> layers_of(const MergeCase& merge_case) {
  return {{&merge_case.a, Transform::Identity(), 1}, {&merge_case.b, merge_case.T_A_B, 1}};
}

MergedMap compose_all(const MergeCase& merge_case) {
  return compose(layers_of(merge_case), {}, Policy::kMean, merge_case.resolution);
}

/// The bricks nearest to one of them: what a robot sees anew when it looks once more at a place.
std::vector<BrickIndex> region_around(std::vector<BrickIndex> bricks, BrickIndex centre, std::size_t count) {
  const auto distance = [&](BrickIndex b) {
    return Eigen::Vector3d(b.x - centre.x, b.y - centre.y, b.z - centre.z).squaredNorm();
  };
  std::stable_sort(bricks.begin(), bricks.end(), [&](BrickIndex a, BrickIndex b) { return distance(a) < distance(b); });
  bricks.resize(std::min(count, bricks.size()));
  return bricks;
}

/// The same brick, every value but one step from what it was.
Brick altered(const Brick& brick) {
  DenseBrick dense;
  brick.to_dense(dense);
  for (LogOdds& l : dense) l = is_known(l) ? static_cast<LogOdds>(l ^ 1) : l;
  return Brick::from_dense(dense);
}

using Change = std::vector<std::pair<BrickIndex, Brick>>;

std::vector<Change> changes_of(const BrickMap& map) {
  const std::vector<BrickIndex> bricks = map.sorted_bricks();
  const auto count = std::max<std::size_t>(1, static_cast<std::size_t>(bricks.size() * kChangedShare + 0.5));
  std::vector<Change> changes;
  for (int i = 0; i < kRegions; ++i) {
    const BrickIndex centre = bricks[(2 * i + 1) * bricks.size() / (2 * kRegions)];
    Change& change = changes.emplace_back();
    for (const BrickIndex index : region_around(bricks, centre, count)) {
      change.emplace_back(index, altered(*map.find(index)));
    }
  }
  return changes;
}

/// What `merge` does when bricks arrive: into the layer, mark what they touch, fold that, into the map.
void update(MergeCase& merge_case, Change change, MergedMap& map) {
  const LatticeTransform transform(merge_case.T_A_B, merge_case.resolution);
  BrickSet dirty;
  for (auto& [index, brick] : change) {
    if (merge_case.b.set(index, std::move(brick))) transform.touch(index, dirty);
  }
  for (FoldedBrick& folded : fold(layers_of(merge_case), {}, Policy::kMean, merge_case.resolution, dirty)) {
    apply(std::move(folded), map);
  }
}

struct Trees {
  octomap::OcTree a;
  octomap::OcTree b;
};

double naive_seconds(const Trees& trees, const MergeCase& merge_case, MergeFigures& figures) {
  const std::size_t before = heap_in_use();
  PapersMerge merge(merge_case.resolution);
  const double time = seconds([&] {
    merge.add(trees.a, Transform::Identity(), 1.0F);
    merge.add(trees.b, merge_case.T_A_B, 1.0F);
  });
  figures.naive_bytes_per_voxel =
      static_cast<double>(heap_in_use() - before) / static_cast<double>(known_count(merge.map()));
  return time;
}

void measure_memory(const MergeCase& merge_case, MergeFigures& figures) {
  const std::size_t before = heap_in_use();
  const MergedMap map = compose_all(merge_case);
  const std::size_t bytes = heap_in_use() - before + merge_case.layer_bytes;
  figures.bytes_per_voxel = static_cast<double>(bytes) / static_cast<double>(map.values.known_count());
}

}  // namespace

MergeFigures measure(MergeCase& merge_case) {
  MergeFigures figures;
  const Trees trees{to_octree(merge_case.a, merge_case.resolution), to_octree(merge_case.b, merge_case.resolution)};
  figures.voxels = merge_case.a.known_count() + merge_case.b.known_count();
  const std::vector<Change> changes = changes_of(merge_case.b);
  figures.update_bricks = changes[0].size();
  MergedMap map = compose_all(merge_case);  // also makes the working memory that is kept
  measure_memory(merge_case, figures);

  std::vector<double> naive;
  std::vector<double> full;
  std::vector<double> updates;
  for (int round = 0; round < kRounds; ++round) {
    naive.push_back(naive_seconds(trees, merge_case, figures));
    for (int i = 0; i < kFullsPerRound; ++i)
      full.push_back(seconds([&] { const MergedMap m = compose_all(merge_case); }));
    for (const Change& change : changes) {
      Change back;
      for (const auto& [index, brick] : change) back.emplace_back(index, *merge_case.b.find(index));
      Change forth = change;
      updates.push_back(seconds([&] { update(merge_case, std::move(forth), map); }));
      updates.push_back(seconds([&] { update(merge_case, std::move(back), map); }));
    }
  }

  const auto voxels = static_cast<double>(figures.voxels);
  figures.full_ratio = median(naive) / median(full);
  figures.update_ratio = median(naive) / median(updates);
  figures.memory_ratio = figures.naive_bytes_per_voxel / figures.bytes_per_voxel;
  figures.mvoxels_per_s = voxels / median(full) * 1e-6;
  figures.naive_mvoxels_per_s = voxels / median(naive) * 1e-6;
  figures.voxels_per_brick = voxels / static_cast<double>(merge_case.a.brick_count() + merge_case.b.brick_count());
  figures.update_ms = median(updates) * 1e3;
  return figures;
}

}  // namespace concord::bench
