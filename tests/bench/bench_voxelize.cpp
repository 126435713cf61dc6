// Exact solid voxels of a model, beside the plain way: every triangle's box asked voxel by voxel in doubles, then a ray
// through every column of an OcTree, against all triangles.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <stdexcept>

#include <octomap/OcTree.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "semantic/models/model_file.hpp"
#include "semantic/models/solid_voxels.hpp"

namespace concord::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Point = Eigen::Vector3d;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

TriangleMesh ball(unsigned n) {
  TriangleMesh mesh;
  for (unsigned i = 0; i <= n; ++i) {
    for (unsigned j = 0; j < 2 * n; ++j) {
      const double a = M_PI * i / n, b = M_PI * j / n, across = i == 0 || i == n ? 0.0 : std::sin(a);
      mesh.vertices.emplace_back(across * std::cos(b), across * std::sin(b), std::cos(a));
    }
  }
  const auto at = [&](unsigned i, unsigned j) { return i * 2 * n + j % (2 * n); };
  for (unsigned i = 0; i < n; ++i) {
    for (unsigned j = 0; j < 2 * n; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

/// Akenine-Moeller's test in doubles; sides closed.
bool overlap(const Point& centre, double half, const std::array<Point, 3>& t) {
  const std::array<Point, 3> v{t[0] - centre, t[1] - centre, t[2] - centre};
  const std::array<Point, 3> edges{v[1] - v[0], v[2] - v[1], v[0] - v[2]};
  const auto apart = [&](const Point& axis) {
    const double a = v[0].dot(axis), b = v[1].dot(axis), c = v[2].dot(axis), r = half * axis.cwiseAbs().sum();
    return std::min({a, b, c}) > r || std::max({a, b, c}) < -r;
  };
  for (int i = 0; i < 3; ++i) {
    if (apart(Point::Unit(i))) return false;
    for (const Point& e : edges) {
      if (apart(e.cross(Point::Unit(i)))) return false;
    }
  }
  return !apart(edges[0].cross(edges[1]));
}

/// Heights at which a line along z crosses a triangle.
void cross(const std::array<Point, 3>& t, double x, double y, std::vector<double>& out) {
  const double ax = t[1].x() - t[0].x(), ay = t[1].y() - t[0].y(), bx = t[2].x() - t[0].x(), by = t[2].y() - t[0].y();
  const double area = ax * by - ay * bx, px = x - t[0].x(), py = y - t[0].y();
  if (area == 0) return;
  const double u = (px * by - py * bx) / area, w = (ax * py - ay * px) / area;
  if (u < 0 || w < 0 || u + w > 1) return;
  out.push_back(t[0].z() + u * (t[1].z() - t[0].z()) + w * (t[2].z() - t[0].z()));
}

std::size_t plain(const TriangleMesh& mesh, const Transform& T, double r) {
  octomap::OcTree tree(r);
  std::vector<std::array<Point, 3>> triangles;
  Point low = Point::Constant(1e9), high = -low;
  for (const auto& corners : mesh.triangles) {
    std::array<Point, 3> t;
    for (std::size_t i = 0; i < 3; ++i) {
      t[i] = T * mesh.vertices[corners[i]];
      low = low.cwiseMin(t[i]), high = high.cwiseMax(t[i]);
    }
    triangles.push_back(t);
  }
  const auto cell = [&](double c) { return static_cast<int>(std::floor(c / r)); };
  for (const auto& t : triangles) {
    const Point a = t[0].cwiseMin(t[1]).cwiseMin(t[2]), b = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
    for (int x = cell(a.x()); x <= cell(b.x()); ++x) {
      for (int y = cell(a.y()); y <= cell(b.y()); ++y) {
        for (int z = cell(a.z()); z <= cell(b.z()); ++z) {
          const Point centre((x + 0.5) * r, (y + 0.5) * r, (z + 0.5) * r);
          if (overlap(centre, r / 2, t))
            tree.updateNode(octomap::point3d(static_cast<float>(centre.x()), static_cast<float>(centre.y()),
                                             static_cast<float>(centre.z())),
                            true, true);
        }
      }
    }
  }
  std::vector<double> heights;
  for (int x = cell(low.x()); x <= cell(high.x()); ++x) {
    for (int y = cell(low.y()); y <= cell(high.y()); ++y) {
      heights.clear();
      for (const auto& t : triangles) cross(t, (x + 0.5) * r, (y + 0.5) * r, heights);
      std::sort(heights.begin(), heights.end());
      for (std::size_t i = 0; i + 1 < heights.size(); i += 2) {
        for (int z = cell(heights[i]); (z + 0.5) * r < heights[i + 1]; ++z) {
          if ((z + 0.5) * r > heights[i])
            tree.updateNode(octomap::point3d(static_cast<float>((x + 0.5) * r), static_cast<float>((y + 0.5) * r),
                                             static_cast<float>((z + 0.5) * r)),
                            true, true);
        }
      }
    }
  }
  tree.updateInnerOccupancy();
  return tree.getNumLeafNodes();
}

int main(int argc, char** argv) {
  CLI::App app{"Exact solid voxels of a model, beside triangle boxes in doubles and a ray a column into an OcTree."};
  std::string model;
  double resolution = 0.05;
  bool json = false;
  app.add_option("model", model, "without it a ball of 1 m radius and 40,000 triangles");
  app.add_option("--resolution", resolution, "metres")->capture_default_str();
  app.add_flag("--json", json, "end with one line of JSON");
  CLI11_PARSE(app, argc, argv);
  TriangleMesh mesh = ball(100);
  if (!model.empty()) {
    auto read = read_model_file(model);
    if (!read) throw std::runtime_error(read.error().message);
    mesh = std::move(*read);
  }
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(0.4, Point(1, 2, 3).normalized()).toRotationMatrix();
  double ours = 1e9, theirs = 1e9;
  std::int64_t voxels = 0;
  std::size_t leaves = 0;
  for (int i = 0; i < 3; ++i) {
    auto start = Clock::now();
    const auto solid = voxelize(mesh, {T, 1.0}, resolution, Fill::kSolid);
    if (!solid) throw std::runtime_error(solid.error().message);
    ours = std::min(ours, ms_since(start));
    voxels = solid->surface.count() + solid->interior.count();
    start = Clock::now();
    leaves = plain(mesh, T, resolution);
    theirs = std::min(theirs, ms_since(start));
  }
  std::printf("%zu triangles, %lld voxels: %.1f ms; the plain way %.1f ms (%zu leaves): %.1f times as fast\n",
              mesh.triangles.size(), static_cast<long long>(voxels), ours, theirs, leaves, theirs / ours);
  if (json) std::printf("%s\n", nlohmann::json{{"ms", ours}, {"plain_ms", theirs}, {"voxels", voxels}}.dump().c_str());
  return 0;
}

}  // namespace
}  // namespace concord::bench

int main(int argc, char** argv) {
  try {
    return concord::bench::main(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_voxelize: %s\n", error.what());
    return 2;
  }
}
