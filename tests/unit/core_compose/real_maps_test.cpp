#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include "core/compose.hpp"

namespace concord {
namespace {

constexpr double kTolerance = 1e-4;  // of a voxel

/// A map from a robot, as an expanded octree (the reference) and in bricks.
struct RealMap {
  octomap::OcTree tree;
  BrickMap map;

  explicit RealMap(const std::string& path) : tree(path) {
    tree.expand();
    std::map<BrickIndex, DenseBrick> dense;
    for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
      const auto key = leaf.getKey();
      const VoxelIndex voxel{key[0] - 32768, key[1] - 32768, key[2] - 32768};
      const auto [it, is_new] = dense.try_emplace(brick_of(voxel));
      if (is_new) it->second.fill(kUnknown);
      it->second[local_of(voxel)] = to_log_odds(leaf->getLogOdds());
    }
    for (const auto& [index, brick] : dense) map.set(index, Brick::from_dense(brick));
  }

  [[nodiscard]] LogOdds at(const Eigen::Vector3d& p) const {
    const octomap::OcTreeNode* node = tree.search(p.x(), p.y(), p.z());
    return node != nullptr ? to_log_odds(node->getLogOdds()) : kUnknown;
  }
};

bool near_boundary(const Eigen::Vector3d& p) { return ((p.array() - p.array().round()).abs() < kTolerance).any(); }

/// A map brought into another's frame by the rules alone, one voxel at a time.
class Reference {
 public:
  Reference(const RealMap& map, const Transform& T) : map_(map), T_(T), inverse_(T.inverse()) {
    const double r = map.tree.getResolution();
    map.map.for_each_brick([&](BrickIndex index, const Brick& brick) {
      brick.for_each([&](int local, LogOdds l) {
        if (!is_occupied(l)) return;
        const Eigen::Vector3d p = T * centre_of(voxel_at(index, local), r);
        if (near_boundary(p / r)) uncertain_.insert(brick_of(voxel_of(p, r)));
        LogOdds& raised = raised_.try_emplace(voxel_of(p, r), kUnknown).first->second;
        raised = std::max(raised, l);
      });
    });
  }

  /// Nothing where rounding may decide.
  [[nodiscard]] std::optional<LogOdds> at(VoxelIndex voxel) const {
    const double r = map_.tree.getResolution();
    const Eigen::Vector3d p = inverse_ * centre_of(voxel, r);
    if (near_boundary(p / r) || uncertain_.contains(brick_of(voxel))) return std::nullopt;
    const auto raised = raised_.find(voxel);
    return std::max(map_.at(p), raised != raised_.end() ? raised->second : kUnknown);
  }

  /// Where the map's voxels lead: all bricks in which `at` may know anything.
  void reach(std::set<BrickIndex>& out) const {
    const double r = map_.tree.getResolution();
    map_.map.for_each_brick([&](BrickIndex index, const Brick& brick) {
      brick.for_each([&](int local, LogOdds) {
        const VoxelIndex v = voxel_of(T_ * centre_of(voxel_at(index, local), r), r);
        for (int corner = 0; corner < 8; ++corner) {
          out.insert(brick_of(
              VoxelIndex{v.x + (corner & 1 ? 1 : -1), v.y + (corner & 2 ? 1 : -1), v.z + (corner & 4 ? 1 : -1)}));
        }
      });
    });
  }

 private:
  const RealMap& map_;
  Transform T_;
  Transform inverse_;
  std::unordered_map<VoxelIndex, LogOdds, IndexHash> raised_;
  std::set<BrickIndex> uncertain_;  // bricks with an occupied voxel on a boundary: rare, so left out whole
};

LogOdds expected_value(LogOdds a, LogOdds b, Policy policy) {
  if (!is_known(a) || !is_known(b) || policy == Policy::kTable) return std::max(a, b);
  const int sum = a + b;
  if (sum < 0) return static_cast<LogOdds>(-((1 - sum) / 2));
  return static_cast<LogOdds>((sum + 1) / 2);
}

void expect_reference(const std::filesystem::path& a_path, const std::filesystem::path& b_path, Policy policy) {
  if (!std::filesystem::exists(a_path)) GTEST_SKIP() << "skipped: the shared data is not here: " << a_path;
  const RealMap a(a_path);
  const RealMap b(b_path);
  ASSERT_EQ(a.tree.getResolution(), b.tree.getResolution());
  const double r = a.tree.getResolution();
  Transform T = Transform::Identity();
  T.translate(Eigen::Vector3d(0.413, -0.277, 0.119));
  T.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d(0.1, -0.2, 1).normalized()));
  const std::vector<Layer> layers{{&a.map, Transform::Identity(), 1}, {&b.map, T, 1}};
  const MergedMap merged = compose(layers, {}, policy, r);

  const Reference b_in_a(b, T);
  std::set<BrickIndex> bricks;
  for (const BrickIndex index : a.map.sorted_bricks()) bricks.insert(index);
  b_in_a.reach(bricks);
  std::size_t checked = 0;
  std::size_t different = 0;
  std::size_t open = 0;
  for (const BrickIndex index : bricks) {
    for (int local = 0; local < kBrickVoxels; ++local) {
      const VoxelIndex voxel = voxel_at(index, local);
      const std::optional<LogOdds> of_b = b_in_a.at(voxel);
      if (!of_b.has_value()) {
        ++open;
        continue;
      }
      const LogOdds of_a = a.at(centre_of(voxel, r));
      const bool conflict = std::max(of_a, *of_b) >= kConflictOccupied && is_free(std::min(of_a, *of_b)) &&
                            std::min(of_a, *of_b) <= kConflictFree;
      different += merged.values.at(voxel) != expected_value(of_a, *of_b, policy);
      different += is_known(merged.conflicts.at(voxel)) != conflict;
      ++checked;
    }
  }
  merged.values.for_each_brick([&](BrickIndex index, const Brick&) { different += !bricks.contains(index); });
  EXPECT_EQ(different, 0U) << "of " << checked;
  EXPECT_LT(open * 50, checked);
}

const std::filesystem::path kData = CONCORD_SHARED_DATA;

TEST(RealMaps, OfHeadsetsEqualTheReferenceByMean) {
  expect_reference(kData / "slam_xr_maps/test4.bt", kData / "slam_xr_maps/test5.bt", Policy::kMean);
}

TEST(RealMaps, OfOneBuildingEqualTheReferenceByTable) {
  expect_reference(kData / "octomap/geb079.bt", kData / "octomap/geb079.bt", Policy::kTable);
}

}  // namespace
}  // namespace concord
