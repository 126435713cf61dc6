// One touch in real rooms: the mean IoU of what is proposed against the true boxes, per class.

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "semantic/models/model_file.hpp"
#include "semantic/models/solid_voxels.hpp"
#include "semantic/segmentation/room_planes.hpp"
#include "semantic/segmentation/segment.hpp"

namespace concord::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kResolution = 0.05;
constexpr std::size_t kSeedsSpread = 12;

struct TrueBox {
  std::string label;
  std::vector<Eigen::Vector3d> corners;  ///< [0] to [1], [2] and [4] are its edges

  /// @param beyond metres by which a point may lie outside
  [[nodiscard]] bool holds(const Eigen::Vector3d& p, double beyond = 0.0) const {
    for (const int i : {1, 2, 4}) {
      const Eigen::Vector3d edge = corners[static_cast<std::size_t>(i)] - corners[0];
      const double along = (p - corners[0]).dot(edge) / edge.norm();
      if (along < -beyond || along > edge.norm() + beyond) return false;
    }
    return true;
  }
  [[nodiscard]] Eigen::Vector3d centre() const { return (corners[0] + corners[7]) / 2; }
};

std::vector<TrueBox> boxes_of(const fs::path& file) {
  nlohmann::json all;
  std::ifstream(file) >> all;
  std::vector<TrueBox> boxes;
  for (const auto& one : all.at("boxes")) {
    TrueBox box{one.at("label"), {}};
    for (const auto& c : one.at("corners_m")) box.corners.emplace_back(c[0], c[1], c[2]);
    boxes.push_back(box);
  }
  return boxes;
}

double iou(const BrickMasks& truth, const BrickMasks& proposed) {
  BrickMasks both = truth, only_truth = truth;
  both.insert(proposed);
  only_truth.erase(proposed);
  const auto shared = static_cast<double>(truth.count() - only_truth.count());
  return both.empty() ? 0.0 : shared / static_cast<double>(both.count());
}

struct Score {
  double at_centre = 0.0, spread = 0.0;
  double without_room = 0.0;  ///< at the centre; floor and walls that lie in the box are not asked for
  double near_box = 0.0;      ///< so, too, and what lies within a voxel of the box is asked for
  double best = 0.0;          ///< what all furniture within a voxel of the box would have instead of `at_centre`
  std::int64_t voxels = 0, proposed = 0;
  int kind = -1;
};

/// The seed is the occupied voxel nearest to the box's centre, as if touched from there; `spread` is the mean over
/// seeds all over the object above its lowest layer.
Score score(const BrickMasks& occupied, const BrickMasks& room, const TrueBox& box) {
  BrickMasks truth, near_box;
  std::vector<VoxelIndex> in_box;
  for (const VoxelIndex v : occupied.voxels()) {
    if (box.holds(centre_of(v, kResolution))) in_box.push_back(v), truth.insert(v);
    if (box.holds(centre_of(v, kResolution), kResolution)) near_box.insert(v);
  }
  Score out;
  out.voxels = truth.count();
  const auto ask = [&](const Eigen::Vector3d& p) {
    const auto proposal = propose_object(occupied, kResolution, p);
    if (proposal) out.kind = static_cast<int>(proposal->kind), out.proposed = proposal->voxels.count();
    return proposal ? iou(truth, proposal->voxels) : 0.0;
  };
  std::size_t seeds = 0;
  std::vector<VoxelIndex> above;
  for (const VoxelIndex v : in_box) {
    if (v.z > 1) above.push_back(v);
  }
  for (std::size_t i = 0; i < kSeedsSpread && !above.empty(); ++i, ++seeds) {
    out.spread += ask(centre_of(above[(2 * i + 1) * above.size() / (2 * kSeedsSpread)], kResolution));
  }
  if (seeds > 0) out.spread /= static_cast<double>(seeds);
  out.at_centre = ask(box.centre());
  const auto proposal = propose_object(occupied, kResolution, box.centre());
  BrickMasks furniture = truth;
  furniture.erase(room);
  near_box.erase(room);
  out.best = iou(truth, near_box);
  out.without_room = proposal ? iou(furniture, proposal->voxels) : 0.0;
  out.near_box = proposal ? iou(near_box, proposal->voxels) : 0.0;
  return out;
}

int main(int argc, char** argv) {
  CLI::App app{"One touch in real rooms: IoU of the proposed voxels with those in the true box."};
  const char* data = std::getenv("CONCORD_DATA");
  std::string folder = (fs::path(data != nullptr ? data : CONCORD_SHARED_DATA) / "quest3_rooms").string();
  bool json = false;
  app.add_option("folder", folder, "NAME.ply beside NAME.labels.json");
  app.add_flag("--json", json, "end with one line of JSON");
  CLI11_PARSE(app, argc, argv);
  std::map<std::string, std::vector<Score>> classes;
  std::vector<fs::path> rooms;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".ply") rooms.push_back(entry.path());
  }
  std::sort(rooms.begin(), rooms.end());
  for (const fs::path& room : rooms) {
    const auto mesh = read_model_file(room);
    if (!mesh) throw std::runtime_error(mesh.error().message);
    const auto voxels = voxelize(*mesh, {}, kResolution, Fill::kSurface);
    if (!voxels) throw std::runtime_error(voxels.error().message);
    for (const TrueBox& box : boxes_of(fs::path(room).replace_extension(".labels.json"))) {
      const Score one = score(voxels->surface, find_room_planes(voxels->surface, kResolution).voxels, box);
      static constexpr const char* kKinds[] = {"none", "flat top", "upright", "cluster"};
      std::printf("%-14s %-8s %6lld true, %6lld proposed as %-8s ", room.stem().c_str(), box.label.c_str(),
                  static_cast<long long>(one.voxels), static_cast<long long>(one.proposed), kKinds[one.kind + 1]);
      std::printf("IoU %.2f of at best %.2f (without floor and walls %.2f, with what is near %.2f), all over it %.2f\n",
                  one.at_centre, one.best, one.without_room, one.near_box, one.spread);
      if (one.voxels > 10) classes[box.label].push_back(one);
    }
  }
  nlohmann::json out;
  for (const auto& [label, scores] : classes) {
    const auto mean = [&scores = scores](double Score::*of) {
      double sum = 0.0;
      for (const Score& one : scores) sum += one.*of;
      return sum / static_cast<double>(scores.size());
    };
    out[label] = {{"objects", scores.size()},
                  {"iou", mean(&Score::at_centre)},
                  {"iou_at_best", mean(&Score::best)},
                  {"iou_without_room", mean(&Score::without_room)},
                  {"iou_near_box", mean(&Score::near_box)},
                  {"iou_all_over", mean(&Score::spread)}};
    std::printf("%-8s %2zu objects:", label.c_str(), scores.size());
    for (const auto& [name, value] : out[label].items()) {
      if (name != "objects") std::printf(" %s %.2f", name.c_str(), value.get<double>());
    }
    std::printf("\n");
  }
  if (json) std::printf("%s\n", out.dump().c_str());
  return 0;
}

}  // namespace
}  // namespace concord::bench

int main(int argc, char** argv) {
  try {
    return concord::bench::main(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_segment: %s\n", error.what());
    return 2;
  }
}
