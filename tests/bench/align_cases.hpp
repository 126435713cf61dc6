#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "align/align.hpp"
#include "core/brick_map.hpp"

namespace concord::bench {

/// Numbers that are the same on any machine (SplitMix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  double uniform(double low, double high);
  double normal();

 private:
  std::uint64_t state_;
};

/// A map as files and agents have it: voxels with free space, or only points.
struct Scene {
  std::string name;
  double resolution = 0.0;
  std::vector<Eigen::Vector3f> points;  ///< of a cloud; empty when `map` is used
  BrickMap map;
};

/// Two scenes and where the second lies in the first.
struct Pair {
  std::string name;
  Scene target, source;
  Transform T_target_source = Transform::Identity();
  double gate = 0.15;    ///< metres that count as found
  double overlap = 1.0;  ///< share of the smaller part that both have, as cut; 1 where it is not known
};

/// `.bt` and `.ot` as voxels; `.pcd` and `.ply` as points, of a mesh such that none is farther than half a voxel.
[[nodiscard]] Scene load_scene(const std::filesystem::path& file, double cloud_resolution);
[[nodiscard]] AlignMap prepared(const Scene& scene, int threads);

/// The parts of a cloud on either side of an upright cut, `overlap` of each in both, with noise of `sigma`, each as an
/// agent would have it: the second turned and shifted at random.
[[nodiscard]] Pair cut_in_two(const Scene& room, double overlap, double sigma, Random& random);

/// Moves a scene: a cloud point by point; a map by its occupied and free voxels' centres (upright maps only lose what
/// falls together).
[[nodiscard]] Scene moved(const Scene& scene, const Transform& T_new_old);
[[nodiscard]] Scene mirrored(const Scene& scene);

[[nodiscard]] Eigen::Vector3d middle_of(const Scene& scene);

/// The truth, wrong by up to 2 m on each axis, 45 degrees of yaw and 5 of roll and pitch; turned about the source's
/// origin, or about its middle.
[[nodiscard]] Transform rough_guess(const Pair& pair, Random& random);

/// Where it was found against where it is: metres at the source's middle, degrees.
struct Miss {
  double metres = 0.0, degrees = 0.0;
};
[[nodiscard]] Miss miss_of(const Pair& pair, const Transform& T_target_source);

/// Folder of the real data: CONCORD_DATA, else beside the checkout.
[[nodiscard]] std::filesystem::path data_folder();
/// Those of the real pairs that are there.
[[nodiscard]] std::vector<Pair> real_pairs();
[[nodiscard]] std::vector<Scene> quest_rooms();

}  // namespace concord::bench
