#include "agent/sim/ray_caster.hpp"

#include <gtest/gtest.h>

#include "agent/sim/random.hpp"

namespace concord {
namespace {

std::optional<Hit> cast_plainly(const World& world, const Ray& ray, double range, Glass glass) {
  std::optional<Hit> nearest;
  for (std::size_t i = 0; i < world.solids.size(); ++i) {
    if (world.solids[i].material == Material::kGlass && glass == Glass::kLetsThrough) continue;
    const std::optional<double> distance = enters(ray, world.solids[i]);
    if (distance && *distance <= range && (!nearest || *distance < nearest->distance)) nearest = Hit{*distance, i};
  }
  return nearest;
}

Ray random_ray(Random& random) {
  const Eigen::Vector3d direction(random.normal(), random.normal(), 0.5 * random.normal());
  const Eigen::Vector3d origin(random.uniform(-2, 26), random.uniform(-2, 18), random.uniform(-1, 6));
  return {origin, direction.normalized()};
}

TEST(RayCaster, FindsWhatTestingEverySolidFinds) {
  const World world = make_warehouse(3);
  const RayCaster caster(world);
  Random random(1);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Ray ray = random_ray(random);
    const double range = random.uniform(0.1, 30);
    const Glass glass = i % 2 == 0 ? Glass::kStops : Glass::kLetsThrough;
    const std::optional<Hit> expected = cast_plainly(world, ray, range, glass);
    const std::optional<Hit> found = caster.cast(ray, range, glass);
    ASSERT_EQ(found.has_value(), expected.has_value()) << i;
    if (!found) continue;
    ++hits;
    EXPECT_EQ(found->distance, expected->distance) << i;
    EXPECT_EQ(found->solid, expected->solid) << i;
  }
  EXPECT_GT(hits, 5000);
}

TEST(RayCaster, FollowsTheAxes) {
  const World world = make_warehouse(3);
  const RayCaster caster(world);
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}}) {
    for (const double sign : {-1.0, 1.0}) {
      const Ray ray{{16.5, 8.0, 1.0}, sign * axis};
      const std::optional<Hit> expected = cast_plainly(world, ray, 30, Glass::kStops);
      const std::optional<Hit> found = caster.cast(ray, 30, Glass::kStops);
      ASSERT_EQ(found.has_value(), expected.has_value());
      if (found) {
        EXPECT_EQ(found->distance, expected->distance);
      }
    }
  }
}

TEST(RayCaster, LooksThroughGlassOnlyWhenTold) {
  const World world = make_warehouse(3);
  const RayCaster caster(world);
  const Ray ray{{16, 3, 1.5}, {1, 0, 0}};
  const std::optional<Hit> stopped = caster.cast(ray, 30, Glass::kStops);
  const std::optional<Hit> through = caster.cast(ray, 30, Glass::kLetsThrough);
  ASSERT_TRUE(stopped && through);
  EXPECT_DOUBLE_EQ(stopped->distance, 1.5);
  EXPECT_EQ(caster.material(stopped->solid), Material::kGlass);
  EXPECT_DOUBLE_EQ(through->distance, 8);
}

TEST(Enters, ATurnedBox) {
  const Solid solid{{2, 0, 0}, {1, 1, 1}, 3.14159265358979323846 / 4, Material::kOpaque};
  const std::optional<double> distance = enters({{0, 0, 0}, {1, 0, 0}}, solid);
  ASSERT_TRUE(distance);
  EXPECT_NEAR(*distance, 2 - std::sqrt(2.0), 1e-12);
  EXPECT_FALSE(enters({{0, 1.5, 0}, {1, 0, 0}}, solid));
  EXPECT_FALSE(enters({{2, 0, 0}, {1, 0, 0}}, solid)) << "from inside";
  EXPECT_FALSE(enters({{4, 0, 0}, {1, 0, 0}}, solid)) << "behind";
}

}  // namespace
}  // namespace concord
