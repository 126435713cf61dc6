#include "planner/free_space.hpp"

#include <array>

#include <gtest/gtest.h>

#include "planner/clearance.hpp"
#include "sketch.hpp"

namespace concord {
namespace {

constexpr int kWidth = 40, kHeight = 30;

TEST(FreeSpace, OpenCellsAreThoseWhoseDiscIsFree) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    const std::array<double, 6> radii{0.0, 0.5, 1.0, 1.5, 2.3, 0.01 * static_cast<double>(random() % 900)};
    const double radius = radii[seed % radii.size()];
    const Cell origin{static_cast<std::int32_t>(random() % 200) - 100, static_cast<std::int32_t>(random() % 200) - 100};
    const Grid grid = test::sketch(test::strewn(random, kWidth, kHeight, 0.01, 0.003), origin);
    FreeSpace space(grid, radius);
    for (std::int32_t y = origin.y - 2; y < origin.y + kHeight + 2; ++y) {
      for (std::int32_t x = origin.x - 2; x < origin.x + kWidth + 2; ++x) {
        const double gap = test::nearest_blocked(grid, x + 0.5, y + 0.5, radius + 1);
        ASSERT_EQ(space.is_open({x, y}), gap > 0 && gap >= radius) << "seed " << seed << " cell " << x << " " << y;
      }
    }
  }
}

TEST(FreeSpace, ADiscWiderThanATileIsRightToo) {
  std::vector<std::string> rows(400, std::string(400, '.'));
  rows[30][35] = '#';
  const Grid grid = test::sketch(rows);
  FreeSpace space(grid, 150.0);
  for (std::int32_t y = 140; y < 260; y += 3) {
    for (std::int32_t x = 140; x < 260; x += 3) {
      const double to_post = test::distance(x + 0.5, y + 0.5, {35, 30});
      const double to_border = std::min({x + 0.5, y + 0.5, 399.5 - x, 399.5 - y});
      ASSERT_EQ(space.is_open({x, y}), std::min(to_post, to_border) >= 150.0) << x << " " << y;
    }
  }
}

TEST(FreeSpace, SeesWhatTheValidatorFindsClear) {
  int seen = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const Cell origin{static_cast<std::int32_t>(random() % 200) - 100, static_cast<std::int32_t>(random() % 200) - 100};
    const Grid grid = test::sketch(test::strewn(random, kWidth, kHeight, 0.006, 0.002), origin);
    const double radius = seed % 3 == 0 ? 0.0 : 0.25 * static_cast<double>(random() % 8);
    FreeSpace space(grid, radius);
    // Half of the points on the half-cell lattice, where lines touch corners exactly.
    const auto point = [&] {
      Eigen::Vector2d p(origin.x + 0.5 * static_cast<double>(random() % (2 * kWidth)),
                        origin.y + 0.5 * static_cast<double>(random() % (2 * kHeight)));
      if (seed % 2 == 0)
        p += Eigen::Vector2d(1e-3 * static_cast<double>(random() % 500), 1e-3 * static_cast<double>(random() % 500));
      return p;
    };
    for (int i = 0; i < 60; ++i) {
      const std::array<Eigen::Vector2d, 2> line{point(), point()};
      const bool clear = is_clear(grid, line, radius);
      ASSERT_EQ(space.sees(line[0], line[1]), clear)
          << "seed " << seed << " r " << radius << " " << line[0].transpose() << " to " << line[1].transpose();
      ASSERT_EQ(space.sees(line[1], line[0]), clear);
      seen += clear ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 1000);
}

}  // namespace
}  // namespace concord
