#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "rooms.hpp"

namespace concord::test {
namespace {

/// The room and a part of it, overlapping by over half, in another frame.
struct Parts {
  AlignMap target, source;
  Transform T_target_source;
};

Parts parts_of(const Points& points, const Transform& T_target_source, int threads = 1) {
  const Points left = kept(points, [](const Eigen::Vector3f& p) { return p.x() < 1.6F; });
  const Points right = kept(points, [](const Eigen::Vector3f& p) { return p.x() > -1.7F; });
  return {cloud_map(left, threads), cloud_map(moved(right, T_target_source.inverse()), threads), T_target_source};
}

void expect_found(const Parts& parts, const Alignment& answer) {
  EXPECT_TRUE(answer.accepted()) << name(answer.reason) << ": " << answer.message;
  EXPECT_LT(metres_off(answer.T_target_source, parts.T_target_source), 0.05);
  EXPECT_LT(degrees_off(answer.T_target_source, parts.T_target_source), 0.5);
}

void expect_same_bits(const Transform& a, const Transform& b) {
  EXPECT_EQ(std::memcmp(a.matrix().data(), b.matrix().data(), 16 * sizeof(double)), 0);
}

TEST(Align, RefinesARoughGuess) {
  const Parts parts = parts_of(room(), transform(3.0, -1.0, 0.4, 0.7));
  for (const Transform& off : {transform(1.9, -1.7, 1.0, degrees(44), degrees(5), degrees(-5)),
                               transform(-1.5, 1.9, -1.9, degrees(-40), degrees(-4), degrees(3))}) {
    Transform guess = parts.T_target_source;
    guess.linear() = off.linear() * guess.linear();
    guess.translation() += off.translation();
    expect_found(parts, align(parts.target, parts.source, guess, 1));
  }
}

TEST(Align, FindsThePlaceWithoutAGuess) {
  const Parts parts = parts_of(room(), transform(3.0, -1.0, 0.4, 2.7));
  const Alignment answer = align(parts.target, parts.source, std::nullopt, 1);
  expect_found(parts, answer);
  EXPECT_GT(answer.overlap(), 0.4);
  EXPECT_LT(answer.rms, 0.02);
  EXPECT_LT(answer.free_space_violation, 0.02);
  EXPECT_GT(answer.iterations, 0);
  EXPECT_TRUE(answer.covariance.allFinite());
  EXPECT_GT(answer.covariance.diagonal().minCoeff(), 0.0);
}

TEST(Align, ToleratesAGravityThatIsOffByThreeDegrees) {
  const Parts parts = parts_of(room(), transform(1.0, 2.0, 0.0, -1.9, degrees(2), degrees(2)));
  expect_found(parts, align(parts.target, parts.source, std::nullopt, 1));
}

TEST(Align, TakesTheTiltThatAGuessMeans) {
  // A frame that lies on its side.
  const Parts parts = parts_of(room(), transform(1.0, 2.0, 0.5, 0.4, 0.0, degrees(90)));
  const Transform guess = parts.T_target_source * transform(0.3, -0.2, 0.2, 0.0, degrees(3), 0.0);
  const Alignment answer = align(parts.target, parts.source, guess, 1);
  expect_found(parts, answer);
  const Parts upright = parts_of(room(), transform(1.0, 2.0, 0.5, 0.4));
  const Alignment twin = align(upright.target, upright.source, upright.T_target_source, 1);
  EXPECT_NEAR(answer.overlap_source, twin.overlap_source, 0.05) << "walls are walls in whatever frame";
  EXPECT_NEAR(answer.against_upright, twin.against_upright, 0.01);
}

TEST(Align, GivesTheSameBitsOnAnyNumberOfThreads) {
  const Transform T = transform(3.0, -1.0, 0.4, 0.7);
  const Parts one = parts_of(room(), T, 1);
  const Alignment expected = align(one.target, one.source, std::nullopt, 1);
  const Alignment guessed = align(one.target, one.source, T * transform(0.4, 0.3, 0.1, 0.3), 1);
  for (const int threads : {2, 3}) {
    const Parts more = parts_of(room(), T, threads);
    const Alignment answer = align(more.target, more.source, std::nullopt, threads);
    expect_same_bits(answer.T_target_source, expected.T_target_source);
    EXPECT_EQ(std::memcmp(&answer.rms, &expected.rms, sizeof(double)), 0);
    EXPECT_EQ(std::memcmp(answer.covariance.data(), expected.covariance.data(), 36 * sizeof(double)), 0);
    EXPECT_EQ(answer.iterations, expected.iterations);
    expect_same_bits(align(more.target, more.source, T * transform(0.4, 0.3, 0.1, 0.3), threads).T_target_source,
                     guessed.T_target_source);
  }
}

TEST(Align, RefusesACorridorAndSaysWhereItSlides) {
  const AlignMap target = cloud_map(corridor(0.0, 10.0));
  const AlignMap source = cloud_map(corridor(3.0, 13.0));
  for (const std::optional<Transform>& guess :
       {std::optional<Transform>(Transform::Identity()), std::optional<Transform>()}) {
    const Alignment answer = align(target, source, guess, 1);
    EXPECT_FALSE(answer.accepted());
    ASSERT_EQ(answer.reason, AlignReason::kDegenerate) << answer.message;
    ASSERT_FALSE(answer.loose.empty());
    EXPECT_EQ(answer.loose.front().rfind("slides along x", 0), 0U) << answer.loose.front();
    EXPECT_GT(std::sqrt(answer.covariance(3, 3)), 0.25) << "it says that it is known along x";
    EXPECT_NE(answer.message.find("slides along x"), std::string::npos);
  }
}

TEST(Align, NamesTheDirectionInTheAxesOfTheTarget) {
  const Transform turned = transform(0.0, 0.0, 0.0, degrees(90));
  const AlignMap target = cloud_map(moved(corridor(0.0, 10.0), turned));
  const AlignMap source = cloud_map(corridor(3.0, 13.0));
  const Alignment answer = align(target, source, turned, 1);
  ASSERT_EQ(answer.reason, AlignReason::kDegenerate) << answer.message;
  EXPECT_EQ(answer.loose.front().rfind("slides along y", 0), 0U) << answer.loose.front();
}

TEST(Align, RefusesAMirroredRoom) {
  const AlignMap target = cloud_map(room());
  const AlignMap source = cloud_map(mirrored(room()));
  EXPECT_FALSE(align(target, source, std::nullopt, 1).accepted());
  EXPECT_FALSE(align(target, source, Transform::Identity(), 1).accepted());
}

/// The parts with a cupboard in each, moved by `by` between the two.
Parts with_a_moved_cupboard(Points left, Points right, const Eigen::Vector3d& by) {
  const Eigen::Vector3d low(-0.6, 0.7, 0.0);
  const Eigen::Vector3d size(0.8, 0.4, 1.6);
  add_box(left, low, low + size, false);
  add_box(right, low + by, low + by + size, false);
  const Transform T = transform(3.0, -1.0, 0.4, 0.7);
  return {cloud_map(left), cloud_map(moved(right, T.inverse())), T};
}

TEST(Align, AGuessIsBelievedThoughACupboardWasMoved) {
  const Points right = kept(room(), [](const Eigen::Vector3f& p) { return p.x() > -1.7F; });
  const Parts parts = with_a_moved_cupboard(room(), right, {0.4, -1.6, 0.0});
  const Alignment answer = align(parts.target, parts.source, parts.T_target_source, 1);
  expect_found(parts, answer);
  EXPECT_GT(answer.against_upright, 0.025) << "nothing was to be forgiven";
  EXPECT_NE(answer.message.find("moved between the two"), std::string::npos) << answer.message;
  EXPECT_EQ(align(parts.target, parts.source, std::nullopt, 1).reason, AlignReason::kDiverged) << "nobody says where";
  EXPECT_FALSE(recheck(parts.target, parts.source, parts.T_target_source, 1).accepted()) << "the watch says so";
}

TEST(Align, RefusesAMirroredRoomInWhichACupboardWasMoved) {
  const Parts parts = with_a_moved_cupboard(left_part(), mirrored(room()), {0.4, -1.6, 0.0});
  EXPECT_FALSE(align(parts.target, parts.source, parts.T_target_source, 1).accepted());
}

/// 20 x 12 m, with shelves along one wall and a cupboard: their mirror images are 3 % of the walls.
Points hall() {
  Points out;
  add_box(out, {-10.0, -6.0, 0.0}, {10.0, 6.0, 3.0});
  add_box(out, {-5.0, 5.3, 0.0}, {5.0, 5.95, 2.0}, false);
  add_box(out, {-6.0, 2.0, 0.0}, {-4.0, 2.5, 1.8}, false);
  return out;
}

TEST(Align, KnowsTheMirrorImageOfAHall) {
  const AlignMap target = cloud_map(hall());
  const AlignMap source = cloud_map(mirrored(hall()));
  const Alignment answer = align(target, source, Transform::Identity(), 2);
  EXPECT_EQ(answer.reason, AlignReason::kDiverged) << answer.message;
  EXPECT_NE(answer.message.find("mirror image"), std::string::npos) << answer.message;
}

TEST(Align, IsNotHeldByACupboardThatMayHaveMoved) {
  for (const double moved_by : {0.0, 0.6, 1.2}) {
    Points before = corridor(0.0, 6.0);
    Points after = before;
    add_box(before, {1.5, 0.05, 0.0}, {3.1, 0.65, 2.2}, false);
    add_box(after, {1.5 + moved_by, 0.05, 0.0}, {3.1 + moved_by, 0.65, 2.2}, false);
    const Alignment answer = align(cloud_map(before), cloud_map(after), Transform::Identity(), 1);
    EXPECT_EQ(answer.reason, AlignReason::kDegenerate) << moved_by << " m: " << answer.message;
    ASSERT_EQ(answer.loose.size(), 1U);
    EXPECT_EQ(answer.loose[0].substr(0, 14), "slides along x");
  }
}

TEST(Align, DoesNotForgiveAPartition) {
  for (const double moved_by : {1.0, 2.0, 3.0}) {
    Points before = room();
    Points after = before;
    add_box(before, {-1.5, -1.8, 0.0}, {-1.3, -0.6, 2.6}, false);
    add_box(after, {-1.5 + moved_by, -1.8, 0.0}, {-1.3 + moved_by, -0.6, 2.6}, false);
    EXPECT_FALSE(align(cloud_map(before), cloud_map(after), Transform::Identity(), 1).accepted()) << moved_by << " m";
  }
}

/// Low enough to be furniture, but no two things: what is that wide may be all that tells two rooms apart.
TEST(Align, DoesNotForgiveACounterThroughHalfTheRoom) {
  for (const double moved_by : {0.5, 0.7}) {
    Points before = room();
    Points after = before;
    add_box(before, {-2.0, -1.9, 0.0}, {1.4, -1.6, 1.1}, false);
    add_box(after, {-2.0, -1.9 + moved_by, 0.0}, {1.4, -1.6 + moved_by, 1.1}, false);
    const Alignment answer = align(cloud_map(before), cloud_map(after), Transform::Identity(), 1);
    EXPECT_EQ(answer.reason, AlignReason::kDiverged) << moved_by << " m: " << answer.message;
  }
}

TEST(Align, DoesNotTakeAGuessAStoreyUp) {
  for (const double storey : {2.4, 2.6, 2.9}) {
    const AlignMap target = cloud_map(moved(room(), transform(0.0, 0.0, storey, 0.0)));
    EXPECT_FALSE(align(target, cloud_map(room()), Transform::Identity(), 1).accepted()) << storey << " m";
  }
}

TEST(Align, RefusesAnotherRoom) {
  const AlignMap target = cloud_map(room());
  const AlignMap source = cloud_map(other_room());
  EXPECT_FALSE(align(target, source, std::nullopt, 1).accepted());
  EXPECT_FALSE(align(target, source, Transform::Identity(), 1).accepted());
}

TEST(Align, RefusesPartsWithoutOverlap) {
  const AlignMap target = cloud_map(kept(room(), [](const Eigen::Vector3f& p) { return p.x() < -0.1F; }));
  const AlignMap source = cloud_map(kept(room(), [](const Eigen::Vector3f& p) { return p.x() > 0.1F; }));
  EXPECT_FALSE(align(target, source, std::nullopt, 1).accepted());
  EXPECT_FALSE(align(target, source, Transform::Identity(), 1).accepted());
}

TEST(Align, RefusesARoomThatIsItsOwnTwin) {
  Points bare;
  add_box(bare, {-2.0, -2.0, 0.0}, {2.0, 2.0, 2.5});
  const AlignMap map = cloud_map(bare);
  const Alignment answer = align(map, map, std::nullopt, 1);
  EXPECT_EQ(answer.reason, AlignReason::kAmbiguous) << answer.message;
  // A person who says which way round settles it.
  EXPECT_TRUE(align(map, map, transform(0.2, -0.3, 0.1, degrees(10)), 1).accepted());
}

TEST(Align, SaysSoWhereThereIsNoMap) {
  const AlignMap full = cloud_map(room());
  const AlignMap empty = cloud_map({});
  EXPECT_EQ(align(full, empty, std::nullopt, 1).reason, AlignReason::kNoMap);
  EXPECT_EQ(align(empty, full, Transform::Identity(), 1).reason, AlignReason::kNoMap);
  EXPECT_EQ(align(empty, empty, std::nullopt, 2).reason, AlignReason::kNoMap);
  EXPECT_EQ(recheck(full, empty, Transform::Identity(), 1).reason, AlignReason::kNoMap);
  EXPECT_STREQ(name(AlignReason::kNoMap), "NO_MAP");
}

TEST(Align, DoesNotFallOverAFlatMap) {
  Points floor;
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 100; ++j)
      floor.emplace_back(0.05F * static_cast<float>(i), 0.05F * static_cast<float>(j), 0.0F);
  }
  const AlignMap flat = cloud_map(floor);
  EXPECT_FALSE(align(flat, flat, std::nullopt, 1).accepted());
  EXPECT_FALSE(align(flat, flat, Transform::Identity(), 1).accepted());
  EXPECT_FALSE(align(cloud_map(room()), flat, Transform::Identity(), 1).accepted());
  // All points in one place, and all on one line.
  const Points spot(1000, Eigen::Vector3f(1.0F, 2.0F, 3.0F));
  EXPECT_FALSE(align(cloud_map(spot), cloud_map(spot), Transform::Identity(), 1).accepted());
}

TEST(Align, SurvivesAGuessThatIsFarAway) {
  const AlignMap map = cloud_map(room());
  EXPECT_FALSE(align(map, map, transform(9000.0, -9000.0, 50.0, 3.0), 1).accepted());
}

TEST(Recheck, CorrectsASmallSlipAndSeesALargeOne) {
  const AlignMap map = cloud_map(room());
  const Alignment slipped = recheck(map, map, transform(0.06, -0.05, 0.03, degrees(1)), 1);
  EXPECT_TRUE(slipped.accepted()) << slipped.message;
  EXPECT_LT(metres_off(slipped.T_target_source, Transform::Identity()), 0.02);
  EXPECT_FALSE(recheck(map, map, transform(1.0, 0.7, 0.0, degrees(20)), 1).accepted());
}

TEST(Align, RecoversRandomTransforms) {
  std::mt19937 random(7);
  const auto within = [&](double reach) { return (static_cast<double>(random()) / 2147483648.0 - 1.0) * reach; };
  const Points points = room();
  const AlignMap target = cloud_map(points);
  for (int i = 0; i < 10; ++i) {
    const double x = within(20.0), y = within(20.0), z = within(3.0);
    const Transform T = transform(x, y, z, within(std::numbers::pi));
    const Alignment answer = align(target, cloud_map(moved(points, T.inverse())), std::nullopt, 2);
    EXPECT_TRUE(answer.accepted()) << answer.message;
    EXPECT_LT(metres_off(answer.T_target_source, T), 0.05);
    EXPECT_LT(degrees_off(answer.T_target_source, T), 0.5);
  }
}

}  // namespace
}  // namespace concord::test
