#include <cmath>

#include "agent/sim/random.hpp"
#include "agent/sim/world.hpp"

namespace concord {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr double kPost = 0.04;
constexpr double kBay = 2.0, kShelfDepth = 0.9, kShelfHeight = 3.6;
constexpr double kShelfX = 5.0;
constexpr double kWall = 0.2;

class Builder {
 public:
  explicit Builder(std::uint64_t seed) : random_(seed) {}

  std::size_t box(const Vector3d& low, const Vector3d& high, Material material = Material::kOpaque, double yaw = 0) {
    world.solids.push_back({(low + high) / 2, (high - low) / 2, yaw, material});
    return world.solids.size() - 1;
  }

  void hall() {
    world.hall = AlignedBox3d(Vector3d::Zero(), Vector3d(kHallX, kHallY, kHallZ));
    floor_ = box({-kWall, -kWall, -kWall}, {kHallX + kWall, kHallY + kWall, 0});
    box({-kWall, -kWall, 0}, {0, kHallY + kWall, kHallZ});
    box({kHallX, -kWall, 0}, {kHallX + kWall, kHallY + kWall, kHallZ});
    box({0, -kWall, 0}, {kHallX, 0, kHallZ});
    box({0, kHallY, 0}, {kHallX, kHallY + kWall, kHallZ});
  }

  /// A row of bays along x: posts, three boards, goods on them. Returns the posts.
  std::vector<std::size_t> shelf(int bays, double y) {
    std::vector<std::size_t> posts;
    const double y0 = y - kShelfDepth / 2, y1 = y + kShelfDepth / 2;
    for (int i = 0; i <= bays; ++i) {
      const double x = kShelfX + i * kBay;
      for (const double side : {y0, y1 - kPost}) {
        posts.push_back(box({x - kPost / 2, side, 0}, {x + kPost / 2, side + kPost, kShelfHeight}));
      }
    }
    for (const double level : {0.12, 1.32, 2.52}) {
      box({kShelfX, y0, level}, {kShelfX + bays * kBay, y1, level + 0.04});
      for (int bay = 0; bay < bays; ++bay) goods(kShelfX + bay * kBay, y, level + 0.04);
    }
    return posts;
  }

  /// A sheet closes one long side of a row.
  void back_panel(int bays, double y0, double y1) { box({kShelfX, y0, 0}, {kShelfX + bays * kBay, y1, kShelfHeight}); }

  void table(double x, double y, double yaw) {
    const double c = std::cos(yaw), s = std::sin(yaw);
    box({x - 0.7, y - 0.35, 0.70}, {x + 0.7, y + 0.35, 0.74}, Material::kOpaque, yaw);
    for (const double lx : {-0.65, 0.65}) {
      for (const double ly : {-0.3, 0.3}) {
        const double px = x + c * lx - s * ly, py = y + s * lx + c * ly;
        box({px - 0.03, py - 0.03, 0}, {px + 0.03, py + 0.03, 0.70}, Material::kOpaque, yaw);
      }
    }
  }

  void pallet(double x, double y) {
    const double height = random_.uniform(0.6, 1.5), yaw = random_.uniform(-0.6, 0.6);
    box({x - 0.5, y - 0.4, 0}, {x + 0.5, y + 0.4, height}, Material::kOpaque, yaw);
  }

  /// A room in the corner at (24, 0): a glass front at x = 17.5, a wall at y = 7 with a doorway.
  void office() {
    constexpr double kFront = 17.5, kSide = 7.0, kThick = 0.12, kDoor0 = 20.0, kDoor1 = 21.2, kTop = 2.6;
    glass_ = box({kFront, 0, 0}, {kFront + 0.012, kSide, 2.5}, Material::kGlass);
    box({kFront - 0.05, kSide, 0}, {kDoor0, kSide + kThick, kTop});
    box({kDoor1, kSide, 0}, {kHallX, kSide + kThick, kTop});
    box({kDoor0, kSide, 2.1}, {kDoor1, kSide + kThick, kTop});
    world.through_glass = {{15.5, 4.5}, {20.5, 3.2}};
  }

  void plate() { plate_ = box({1.7, 12.49, 0.0}, {3.3, 12.51, 1.9}, Material::kMirror); }
  void stand() { stand_ = box({14.4, 9.4, 0.0}, {15.0, 10.0, 0.3}, Material::kBlack, 0.2); }

  void name_features(const std::vector<std::size_t>& posts) {
    constexpr double kAboveFloor = 0.1;  // lower down the floor is within a voxel
    const auto band = [&](double top) {
      return AlignedBox3d(Vector3d(-1, -1, kAboveFloor), Vector3d(kHallX + 1, kHallY + 1, top));
    };
    feature("glass", {glass_}, AlignedBox3d(Vector3d(17, 0.2, kAboveFloor), Vector3d(18, 6.8, 2.4)));
    feature("shelf posts", posts, band(2.2));
    feature("low black stand", {stand_}, band(1));
    feature("narrow aisle", {floor_}, AlignedBox3d(Vector3d(5.2, 10.55, -0.1), Vector3d(12.8, 10.85, 0.1)));
    feature("reflective plate", {plate_}, band(1.8));
  }

  World world;

 private:
  void feature(const char* name, const std::vector<std::size_t>& solids, const AlignedBox3d& region) {
    const bool one_thing = solids.size() == 1 && solids[0] != floor_;
    world.features.push_back({name, solids, region, std::nullopt});
    if (one_thing) world.features.back().edit_box = bounds(world.solids[solids[0]]);
  }

  void goods(double x, double y, double z) {
    for (int half = 0; half < 2; ++half) {
      if (random_.uniform() < 0.2) continue;
      const double width = random_.uniform(0.4, 0.8), depth = random_.uniform(0.4, 0.75);
      const double height = random_.uniform(0.3, 0.9), centre = x + 0.52 + half * 0.96;
      box({centre - width / 2, y - depth / 2, z}, {centre + width / 2, y + depth / 2, z + height}, Material::kOpaque,
          random_.uniform(-0.06, 0.06));
    }
  }

  Random random_;
  std::size_t floor_ = 0, glass_ = 0, plate_ = 0, stand_ = 0;
};

}  // namespace

World make_warehouse(std::uint64_t seed) {
  Builder builder(seed);
  builder.hall();
  std::vector<std::size_t> posts = builder.shelf(5, 3.5);
  const std::vector<std::size_t> more = builder.shelf(5, 6.5);
  posts.insert(posts.end(), more.begin(), more.end());

  // Back to back, 0.5 m apart: a person fits between, a robot does not. The sheets keep eyes outside.
  builder.shelf(4, 10.0);
  builder.shelf(4, 11.4);
  builder.back_panel(4, 10.43, 10.45);
  builder.back_panel(4, 10.95, 10.97);

  builder.office();
  builder.plate();
  builder.stand();
  builder.table(19.0, 11.0, 0.2);
  builder.table(19.2, 13.4, -0.3);
  builder.table(22.8, 10.0, 1.4);
  for (const auto& [x, y] : {std::pair{1.0, 8.6}, {1.2, 5.2}, {9.5, 15.2}, {13.0, 15.1}, {18.9, 1.2}, {22.8, 5.4}}) {
    builder.pallet(x, y);
  }
  builder.name_features(posts);
  return std::move(builder.world);
}

}  // namespace concord
