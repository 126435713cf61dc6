#include "align_cases.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>

#include "cli/cloud_file.hpp"
#include "core/octomap_reader.hpp"

namespace concord::bench {
namespace {

namespace fs = std::filesystem;

template <class T>
T take(Result<T> result, const std::string& what) {
  if (!result.has_value()) throw std::runtime_error(what + ": " + result.error().message);
  return std::move(*result);
}

Transform read_transform(const fs::path& file) {
  std::ifstream in(file);
  Eigen::Matrix4d m;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) in >> m(row, column);
  }
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  Transform T;
  T.linear() = Eigen::Quaterniond(Eigen::Matrix3d(m.topLeftCorner<3, 3>())).normalized().toRotationMatrix();
  T.translation() = m.topRightCorner<3, 1>();
  return T;
}

Eigen::Matrix3d turn(double yaw, double pitch, double roll) {
  return (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

template <class Move>
Scene mapped(const Scene& scene, Move&& move) {
  Scene out{scene.name, scene.resolution, {}, {}};
  for (const Eigen::Vector3f& p : scene.points) out.points.push_back(move(p.cast<double>()).template cast<float>());
  std::map<BrickIndex, DenseBrick> bricks;
  for (const BrickIndex b : scene.map.sorted_bricks()) {
    scene.map.find(b)->for_each([&](int local, LogOdds value) {
      const VoxelIndex to = voxel_of(move(centre_of(voxel_at(b, local), scene.resolution)), scene.resolution);
      const auto [it, is_new] = bricks.try_emplace(brick_of(to));
      if (is_new) it->second.fill(kUnknown);
      LogOdds& cell = it->second[local_of(to)];
      cell = std::max(cell, value);
    });
  }
  for (const auto& [index, dense] : bricks) out.map.set(index, Brick::from_dense(dense));
  return out;
}

}  // namespace

Eigen::Vector3d middle_of(const Scene& scene) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  if (!scene.points.empty()) {
    for (const Eigen::Vector3f& p : scene.points) sum += p.cast<double>();
    return sum / static_cast<double>(scene.points.size());
  }
  for (const BrickIndex b : scene.map.sorted_bricks()) {
    const double n = scene.map.find(b)->occupied_count();
    sum += n * centre_of(voxel_at(b, 0), scene.resolution);
    count += n;
  }
  return sum / std::max(count, 1.0);
}

std::uint64_t Random::next() {
  std::uint64_t z = state_ += 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

double Random::uniform(double low, double high) {
  return low + (high - low) * static_cast<double>(next() >> 11) * 0x1.0p-53;
}

double Random::normal() { return std::sqrt(-2.0 * std::log(uniform(1e-12, 1.0))) * std::cos(uniform(0.0, 2.0 * M_PI)); }

Scene load_scene(const fs::path& file, double cloud_resolution) {
  if (file.extension() == ".bt" || file.extension() == ".ot") {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw std::runtime_error(file.string() + ": cannot be read");
    const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
    OctomapImport import = take(read_octomap_file(bytes, std::nullopt), file.string());
    return {file.filename().string(), import.resolution, {}, std::move(import.map)};
  }
  return {
      file.filename().string(), cloud_resolution, take(read_cloud(file, 0.5 * cloud_resolution), file.string()), {}};
}

AlignMap prepared(const Scene& scene, int threads) {
  if (!scene.points.empty()) return take(make_align_map(scene.points, scene.resolution, threads), scene.name);
  return take(make_align_map(scene.map, scene.resolution, threads), scene.name);
}

Pair cut_in_two(const Scene& room, double overlap, double sigma, Random& random) {
  Pair out{room.name, {room.name, room.resolution, {}, {}}, {room.name, room.resolution, {}, {}}, {}, 0.15, overlap};
  const double direction = random.uniform(0.0, 2.0 * M_PI);
  const Eigen::Vector3f axis(static_cast<float>(std::cos(direction)), static_cast<float>(std::sin(direction)), 0.0F);
  std::vector<float> along;
  for (const Eigen::Vector3f& p : room.points) along.push_back(axis.dot(p));
  std::vector<float> sorted = along;
  std::sort(sorted.begin(), sorted.end());
  const double part = 1.0 / (2.0 - overlap);
  const auto quantile = [&](double q) { return sorted[static_cast<std::size_t>(q * (sorted.size() - 1.0))]; };
  const float high = quantile(part);
  const float low = quantile(1.0 - part);
  out.T_target_source.linear() = turn(random.uniform(-M_PI, M_PI), 0.0, 0.0);
  out.T_target_source.translation() =
      Eigen::Vector3d(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-1, 1));
  const Transform T_source_target = out.T_target_source.inverse();
  for (std::size_t i = 0; i < room.points.size(); ++i) {
    const auto noisy = [&] {
      return Eigen::Vector3d(room.points[i].cast<double>() +
                             sigma * Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
    };
    if (along[i] <= high) out.target.points.push_back(noisy().cast<float>());
    if (along[i] >= low) out.source.points.push_back((T_source_target * noisy()).cast<float>());
  }
  return out;
}

Scene moved(const Scene& scene, const Transform& T_new_old) {
  return mapped(scene, [&](const Eigen::Vector3d& p) -> Eigen::Vector3d { return T_new_old * p; });
}

Scene mirrored(const Scene& scene) {
  Scene out = mapped(scene, [](const Eigen::Vector3d& p) -> Eigen::Vector3d { return {-p.x(), p.y(), p.z()}; });
  out.name += " mirrored";
  return out;
}

Transform rough_guess(const Pair& pair, Random& random) {
  const auto degrees = [&](double d) { return random.uniform(-d, d) * M_PI / 180.0; };
  const Eigen::Matrix3d R = turn(degrees(45.0), degrees(5.0), degrees(5.0));
  const Eigen::Vector3d pivot = random.uniform(0.0, 1.0) < 0.5 ? Eigen::Vector3d::Zero() : middle_of(pair.source);
  const Eigen::Vector3d p_target = pair.T_target_source * pivot;
  const Eigen::Vector3d shift(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
  Transform T;
  T.linear() = R * pair.T_target_source.linear();
  T.translation() = p_target + shift - T.linear() * pivot;
  return T;
}

Miss miss_of(const Pair& pair, const Transform& T_target_source) {
  const Eigen::Vector3d middle = middle_of(pair.source);
  const Eigen::Matrix3d R = pair.T_target_source.linear().transpose() * T_target_source.linear();
  return {(pair.T_target_source * middle - T_target_source * middle).norm(),
          Eigen::AngleAxisd(R).angle() * 180.0 / M_PI};
}

fs::path data_folder() {
  const char* given = std::getenv("CONCORD_DATA");
  return given != nullptr ? fs::path(given) : fs::path(CONCORD_SHARED_DATA);
}

std::vector<Pair> real_pairs() {
  const fs::path data = data_folder();
  std::vector<Pair> out;
  if (fs::exists(data / "balm_building")) {
    const Transform T = read_transform(data / "balm_building/T_A_B_ground_truth.txt");
    for (const std::string ending : {".bt", ".pcd"}) {
      out.push_back({"balm_building" + ending, load_scene(data / ("balm_building/session_A_0.1m" + ending), 0.1),
                     load_scene(data / ("balm_building/session_B_0.1m" + ending), 0.1), T, 0.2, 0.71});
    }
    out.push_back({"balm_building .bt, .pcd", out[0].target, out[1].source, T, 0.2, 0.71});
  }
  if (fs::exists(data / "registration")) {
    out.push_back({"registration", load_scene(data / "registration/target.ply", 0.1),
                   load_scene(data / "registration/source.ply", 0.1),
                   read_transform(data / "registration/T_target_source.txt"), 0.15, 1.0});
  }
  if (fs::exists(data / "slam_xr_maps")) {
    out.push_back({"slam_xr", load_scene(data / "slam_xr_maps/test4.bt", 0.05),
                   load_scene(data / "slam_xr_maps/test5.bt", 0.05), Transform::Identity(), 0.15, 1.0});
    out.push_back({"slam_xr .bt, .pcd", out.back().target, load_scene(data / "slam_xr_maps/test5.pcd", 0.1),
                   Transform::Identity(), 0.15, 1.0});
  }
  return out;
}

std::vector<Scene> quest_rooms() {
  std::vector<Scene> out;
  for (const std::string name : {"meeting_room", "office_large", "office_small"}) {
    const fs::path file = data_folder() / "quest3_rooms" / (name + ".ply");
    if (fs::exists(file)) out.push_back(load_scene(file, 0.05));
  }
  return out;
}

}  // namespace concord::bench
