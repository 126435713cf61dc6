#include "sample_meshes.hpp"

#include <cmath>
#include <numbers>
#include <random>

namespace concord {
namespace {

using Point = Eigen::Vector3d;

/// A grid of points (u, v) closed in both directions where asked, as two triangles a cell.
template <class Surface>
TriangleMesh grid_mesh(unsigned nu, unsigned nv, bool closed_u, bool closed_v, Surface surface) {
  TriangleMesh mesh;
  const unsigned pu = closed_u ? nu : nu + 1, pv = closed_v ? nv : nv + 1;
  for (unsigned i = 0; i < pu; ++i) {
    for (unsigned j = 0; j < pv; ++j) mesh.vertices.push_back(surface(i, j));
  }
  const auto at = [&](unsigned i, unsigned j) { return (i % pu) * pv + j % pv; };
  for (unsigned i = 0; i < nu; ++i) {
    for (unsigned j = 0; j < nv; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TriangleMesh ball(double radius, unsigned n) {
  return grid_mesh(n, 2 * n, false, true, [&](unsigned i, unsigned j) {
    // Exactly one point at each pole, so that its edges meet.
    const double a = std::numbers::pi * i / n, b = std::numbers::pi * j / n;
    const double across = i == 0 || i == n ? 0.0 : std::sin(a);
    return Point(radius * across * std::cos(b), radius * across * std::sin(b), radius * std::cos(a));
  });
}

TriangleMesh ring(double radius, double thickness, unsigned n) {
  return grid_mesh(n, n, true, true, [&](unsigned i, unsigned j) {
    const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / n;
    const double across = radius + thickness * std::cos(b);
    return Point(across * std::cos(a), across * std::sin(a), thickness * std::sin(b));
  });
}

/// A prism or cone over a polygon around the z axis, with both ends.
TriangleMesh tapered(unsigned n, double low_radius, double high_radius, double height) {
  TriangleMesh mesh = grid_mesh(1, n, false, true, [&](unsigned i, unsigned j) {
    const double b = 2 * std::numbers::pi * j / n, r = i == 0 ? low_radius : high_radius;
    return Point(r * std::cos(b), r * std::sin(b), i * height);
  });
  const auto low = static_cast<unsigned>(mesh.vertices.size());
  mesh.vertices.emplace_back(0, 0, 0);
  mesh.vertices.emplace_back(0, 0, height);
  for (unsigned j = 0; j < n; ++j) {
    mesh.triangles.push_back({low, j, (j + 1) % n});
    mesh.triangles.push_back({low + 1, n + j, n + (j + 1) % n});
  }
  return mesh;
}

TriangleMesh without_last(TriangleMesh mesh, std::size_t triangles) {
  mesh.triangles.resize(mesh.triangles.size() - triangles);
  return mesh;
}

/// Triangles that have nothing to do with each other, some without area.
TriangleMesh soup(unsigned seed, unsigned n) {
  std::mt19937 random(seed);
  const auto in = [&](double size) { return (static_cast<double>(random() % 20001) / 10000.0 - 1.0) * size; };
  TriangleMesh mesh;
  for (unsigned i = 0; i < n; ++i) {
    const Point a(in(0.5), in(0.5), in(0.5)), d(in(0.3), in(0.3), in(0.3)), e(in(0.3), in(0.3), in(0.3));
    mesh.vertices.push_back(a);
    mesh.vertices.emplace_back(a + d);
    mesh.vertices.emplace_back(i % 5 == 0 ? Point(a + 0.5 * d) : i % 7 == 0 ? a : Point(a + e));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

}  // namespace

TriangleMesh box_mesh(const Point& low, const Point& high) {
  TriangleMesh mesh;
  for (unsigned i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                               (i & 4) != 0 ? high.z() : low.z());
  }
  for (const auto& q : {std::array{0U, 2U, 3U, 1U},
                        {4U, 5U, 7U, 6U},
                        {0U, 1U, 5U, 4U},
                        {2U, 6U, 7U, 3U},
                        {0U, 4U, 6U, 2U},
                        {1U, 3U, 7U, 5U}}) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh out = a;
  const auto base = static_cast<std::uint32_t>(a.vertices.size());
  out.vertices.insert(out.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) out.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  return out;
}

std::vector<SampleMesh> sample_meshes() {
  const Point zero = Point::Zero(), one(0.5, 0.4, 0.3);
  const TriangleMesh box = box_mesh(zero, one);
  return {{"box on the lattice", box_mesh({-0.2, 0, 0.1}, {0.3, 0.25, 0.4})},
          {"box off the lattice", box_mesh({-0.213, 0.007, 0.111}, {0.317, 0.253, 0.404})},
          {"plate", box_mesh(zero, {0.6, 0.5, 0.004})},
          {"needle", box_mesh(zero, {0.7, 0.003, 0.003})},
          {"dust", box_mesh({0.011, 0.012, 0.013}, {0.012, 0.013, 0.014})},
          {"ball", ball(0.31, 12)},
          {"fine ball", ball(0.2, 24)},
          {"ring", ring(0.3, 0.09, 16)},
          {"thin ring", ring(0.3, 0.02, 12)},
          {"pillar", tapered(9, 0.15, 0.15, 0.5)},
          {"cone", tapered(7, 0.3, 0.0, 0.4)},
          {"stump", tapered(5, 0.3, 0.1, 0.33)},
          {"box in box",
           joined(box_mesh({-0.3, -0.3, -0.3}, {0.3, 0.3, 0.3}), box_mesh({-0.15, -0.1, -0.2}, {0.1, 0.15, 0.2}))},
          {"boxes that overlap", joined(box, box_mesh({0.2, 0.1, 0.05}, {0.7, 0.3, 0.6}))},
          {"boxes that touch", joined(box, box_mesh({0.5, 0, 0}, {0.8, 0.4, 0.3}))},
          {"box twice", joined(box, box)},
          {"open box", without_last(box_mesh(zero, {0.4, 0.4, 0.4}), 2), false},
          {"box with a crack", without_last(joined(box, box_mesh({0.2, 0.1, 0.3}, {0.203, 0.103, 0.301})), 1), false},
          {"one triangle", without_last(box, 11), false},
          {"soup", soup(7, 40), false}};
}

TriangleMesh pump_mesh() {
  return joined(joined(box_mesh({-0.4, -0.2, 0}, {0.4, 0.2, 0.3}), box_mesh({-0.4, -0.15, 0.3}, {0.0, 0.15, 0.7})),
                box_mesh({0.2, -0.05, 0.3}, {0.3, 0.05, 1.0}));
}

}  // namespace concord
