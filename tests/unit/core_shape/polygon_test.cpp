#include "core/polygon.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "random_shapes.hpp"

namespace concord {
namespace {

using Points = std::vector<Eigen::Vector2d>;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double area_of(const Points& points) {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) sum += cross(points[i], points[(i + 1) % points.size()]);
  return std::abs(sum) / 2;
}

double area_of(const Points& points, const Triangle& t) {
  return cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]) / 2;
}

/// Whether any two edges have a point in common that is not their common end: by where their lines meet, exact for
/// small whole numbers.
bool crosses_itself(const Points& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (i == j) continue;
      const Eigen::Vector2d a = p[i], u = p[(i + 1) % n] - a, c = p[j], v = p[(j + 1) % n] - c;
      const double det = cross(u, v);
      if (det != 0) {
        const double s = cross(c - a, v) / det, t = cross(c - a, u) / det;
        const bool joint = (j == (i + 1) % n && s == 1 && t == 0) || (i == (j + 1) % n && s == 0 && t == 1);
        if (s >= 0 && s <= 1 && t >= 0 && t <= 1 && !joint) return true;
      } else if (cross(c - a, u) == 0) {
        const double from = (c - a).dot(u) / u.squaredNorm(), to = from + v.dot(u) / u.squaredNorm();
        const double shared = std::min(1.0, std::max(from, to)) - std::max(0.0, std::min(from, to));
        const bool joint = j == (i + 1) % n || i == (j + 1) % n;
        if (joint ? shared > 0 : shared >= 0) return true;
      }
    }
  }
  return false;
}

Code refusal(const Points& points) {
  const auto triangles = triangulate(points);
  EXPECT_FALSE(triangles.has_value());
  return triangles ? Code::kIo : triangles.error().code;
}

RC_GTEST_PROP(Triangulate, TakesSimplePolygonsAndNoOthersOnASmallGrid, ()) {
  Points points;
  for (int left = *rc::gen::inRange(3, 9); left > 0; --left) {
    const int x = *rc::gen::inRange(0, 5), y = *rc::gen::inRange(0, 5);
    const Eigen::Vector2d p(x, y);
    if (points.empty() || points.back() != p) points.push_back(p);
  }
  while (points.size() > 1 && points.back() == points.front()) points.pop_back();
  RC_PRE(points.size() >= 3);
  const auto triangles = triangulate(points);
  RC_ASSERT(triangles.has_value() == !crosses_itself(points));
  if (!triangles) return;
  RC_CLASSIFY(points.size() > 4, "simple with 5 corners and more");
  double sum = 0;
  for (const Triangle& t : *triangles) {
    RC_ASSERT(area_of(points, t) > 0);
    sum += area_of(points, t);
  }
  RC_ASSERT(sum == area_of(points));
}

RC_GTEST_PROP(Triangulate, TrianglesCoverThePolygonOnce, ()) {
  const Points points = any_polygon(3);
  const auto triangles = triangulate(points);
  RC_ASSERT(triangles.has_value());
  const Eigen::Vector2d p(any_number(-3, 3) + 1e-7, any_number(-3, 3) + 2e-7);
  int holding = 0;
  for (const Triangle& t : *triangles) {
    holding += encloses(Points{points[t[0]], points[t[1]], points[t[2]]}, p, 0) ? 1 : 0;
  }
  RC_ASSERT(holding == (encloses(points, p, 0) ? 1 : 0));
}

TEST(Triangulate, CutsCombsAndSpiralsOfAllSizes) {
  for (const Points& points : {comb(1, 5), comb(255, 300), spiral(7), spiral(500)}) {
    const auto triangles = triangulate(points);
    ASSERT_TRUE(triangles.has_value()) << triangles.error().message;
    double sum = 0;
    for (const Triangle& t : *triangles) sum += area_of(points, t);
    EXPECT_NEAR(sum, area_of(points), 1e-9 * sum);
  }
}

TEST(Triangulate, TakesAClosedListAndCornersOnAStraightLine) {
  const Points points{{0, 0}, {1, 0}, {2, 0}, {2, 0}, {2, 2}, {1, 1}, {0, 0}};
  const auto triangles = triangulate(points);
  ASSERT_TRUE(triangles.has_value());
  double sum = 0;
  for (const Triangle& t : *triangles) sum += area_of(points, t);
  EXPECT_EQ(sum, 2);
}

TEST(Triangulate, RefusesWhatIsNoPolygon) {
  EXPECT_EQ(refusal({}), Code::kBadShape);
  EXPECT_EQ(refusal({{0, 0}, {1, 1}}), Code::kBadShape);
  EXPECT_EQ(refusal({{0, 0}, {1, 1}, {0, 0}}), Code::kBadShape);
  EXPECT_EQ(refusal({{0, 0}, {0.1, 0.3}, {0.2, 0.6}}), Code::kBadShape);
  EXPECT_EQ(refusal({{0, 0}, {1, 1}, {1, 0}, {0, 1}}), Code::kBadShape);
  EXPECT_EQ(refusal({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}), Code::kBadShape) << "a corner on another edge";
  EXPECT_EQ(refusal({{0, 0}, {1, 0}, {std::nan(""), 1}}), Code::kNotFinite);
  EXPECT_EQ(refusal({{0, 0}, {1, 0}, {1, std::numeric_limits<double>::infinity()}}), Code::kNotFinite);
  EXPECT_EQ(refusal({{0, 0}, {1, 0}, {1, 1e300}}), Code::kOutOfBounds);
  EXPECT_EQ(refusal(Points(kMaxShapePoints + 1, Eigen::Vector2d(0, 0))), Code::kTooLarge);
}

TEST(Encloses, CountsTheMarginAroundTheEdges) {
  const Points square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_TRUE(encloses(square, {0.5, 0.5}, 0));
  EXPECT_TRUE(encloses(square, {1.05, 0.5}, 0.1));
  EXPECT_FALSE(encloses(square, {1.05, 0.5}, 0.01));
  EXPECT_FALSE(encloses(square, {1.09, 1.09}, 0.1)) << "round a corner";
}

}  // namespace
}  // namespace concord
