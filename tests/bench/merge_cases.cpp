#include "merge_cases.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>

#include <malloc.h>

#include "core/octomap_reader.hpp"

namespace concord::bench {
namespace {

template <class T>
T take(Result<T> result, const std::string& what) {
  if (!result.has_value()) throw std::runtime_error(what + ": " + result.error().message);
  return std::move(*result);
}

OctomapImport load(const std::string& path, std::optional<double> resolution) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  return take(read_octomap_file(bytes, resolution), path);
}

/// A hall of 12 x 10 x 3 m with rows of shelves, in the map frame.
constexpr double kResolution = 0.05;
const Eigen::Vector3d kHall(12.0, 10.0, 3.0);

bool is_solid(const Eigen::Vector3d& p) {
  if ((p.array() < 0.0).any() || (p.array() > kHall.array()).any()) return true;
  const double row = std::fmod(p.y(), 2.5);
  return row > 1.9 && row < 2.3 && p.x() > 1.5 && p.x() < 10.5 && p.z() < 2.0;
}

using Cells = std::map<BrickIndex, DenseBrick>;

void mark(Cells& cells, const Eigen::Vector3d& p, LogOdds value) {
  const VoxelIndex voxel = voxel_of(p, kResolution);
  const auto [it, is_new] = cells.try_emplace(brick_of(voxel));
  if (is_new) it->second.fill(kUnknown);
  LogOdds& cell = it->second[local_of(voxel)];
  cell = std::max(cell, value);
}

/// `rays` evenly over the sphere (a Fibonacci lattice), each free up to what it hits.
void scan(const Transform& T_agent_map, const Eigen::Vector3d& p_map_sensor, int rays, Cells& cells) {
  const double golden = M_PI * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < rays; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / rays;
    const double radius = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d step =
        Eigen::Vector3d(radius * std::cos(golden * i), radius * std::sin(golden * i), z) * (0.5 * kResolution);
    Eigen::Vector3d p = p_map_sensor;
    for (; !is_solid(p); p += step) mark(cells, T_agent_map * p, kFree);
    mark(cells, T_agent_map * p, kOccupied);
  }
}

BrickMap agent_map(const Transform& T_map_agent, const std::vector<Eigen::Vector3d>& p_map_sensors, int rays) {
  Cells cells;
  for (const Eigen::Vector3d& p : p_map_sensors) scan(T_map_agent.inverse(), p, rays, cells);
  BrickMap map;
  for (const auto& [index, dense] : cells) map.set(index, Brick::from_dense(dense));
  return map;
}

MergeCase hall_case(const std::string& name, int rays) {
  MergeCase out{name, kResolution, {}, {}, default_transform(), 0};
  const std::vector<Eigen::Vector3d> of_a{{1.0, 1.0, 1.2}, {6.0, 3.6, 1.4}, {11.0, 6.1, 1.0}};
  const std::vector<Eigen::Vector3d> of_b{{11.0, 1.2, 1.6}, {6.0, 6.2, 1.1}, {1.0, 8.9, 1.3}};
  const std::size_t before = heap_in_use();
  out.a = agent_map(Transform::Identity(), of_a, rays);
  out.b = agent_map(out.T_A_B, of_b, rays);
  out.layer_bytes = heap_in_use() - before;
  return out;
}

}  // namespace

std::size_t heap_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

Transform default_transform() {
  Transform T = Transform::Identity();
  T.translate(Eigen::Vector3d(0.413, -0.277, 0.119));
  T.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  T.rotate(Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY()));
  T.rotate(Eigen::AngleAxisd(-0.03, Eigen::Vector3d::UnitX()));
  return T;
}

Transform parse_transform(const std::string& transform) {
  if (transform.empty()) return default_transform();
  std::istringstream in(transform);
  std::array<double, 7> v{};
  for (double& number : v) in >> number;
  if (!in || !(in >> std::ws).eof()) throw std::runtime_error("--transform wants \"x y z qx qy qz qw\"");
  return take(make_transform({v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}), "--transform");
}

MergeCase load_case(const std::string& a, const std::string& b, const Transform& T_A_B) {
  MergeCase out{a + " + " + b, 0.0, {}, {}, T_A_B, 0};
  const std::size_t before = heap_in_use();
  OctomapImport first = load(a, std::nullopt);
  OctomapImport second = load(b, first.resolution);
  out.resolution = first.resolution;
  out.a = std::move(first.map);
  out.b = std::move(second.map);
  out.layer_bytes = heap_in_use() - before;
  return out;
}

MergeCase dense_case() { return hall_case("dense", 400000); }
MergeCase sparse_case() { return hall_case("sparse", 4000); }

}  // namespace concord::bench
