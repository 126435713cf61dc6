// Models in rooms as a scanner sees them: from one place or several, with noise, and with the free space in between.
#include <random>

#include <gtest/gtest.h>

#include "core/ray.hpp"
#include "sample_meshes.hpp"
#include "semantic/detections/find_model.hpp"
#include "semantic/models/solid_voxels.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.05;

TriangleMesh chair() {
  TriangleMesh mesh =
      joined(box_mesh({-0.25, -0.25, 0.4}, {0.25, 0.25, 0.46}), box_mesh({-0.25, 0.2, 0.46}, {0.25, 0.25, 0.95}));
  for (const double x : {-0.25, 0.2}) {
    for (const double y : {-0.25, 0.2}) mesh = joined(mesh, box_mesh({x, y, 0}, {x + 0.05, y + 0.05, 0.4}));
  }
  return mesh;
}

TriangleMesh table() {
  TriangleMesh mesh = box_mesh({-0.4, -0.3, 0.65}, {0.4, 0.3, 0.72});
  for (const double x : {-0.4, 0.34}) {
    for (const double y : {-0.3, 0.24}) mesh = joined(mesh, box_mesh({x, y, 0}, {x + 0.06, y + 0.06, 0.65}));
  }
  return mesh;
}

class Room {
 public:
  explicit Room(unsigned seed) : random_(seed) {
    add(box_mesh({-3, -3, -0.1}, {3, 3, -0.05}), Transform::Identity());
    add(box_mesh({-3, -3, 2.5}, {3, 3, 2.55}), Transform::Identity());
    for (const double at : {-3.0, 2.95}) {
      add(box_mesh({at, -3, 0}, {at + 0.05, 3, 2.5}), Transform::Identity());
      add(box_mesh({-3, at, 0}, {3, at + 0.05, 2.5}), Transform::Identity());
    }
    std::shuffle(places_.begin(), places_.end(), random_);
  }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  /// In the next of eight places around the middle, turned anyhow.
  Transform place(const TriangleMesh& mesh) {
    const int at = places_.at(next_++);
    Transform T = Transform::Identity();
    T.translation() =
        Eigen::Vector3d(1.8 * (at % 3 - 1) + uniform(-0.2, 0.2), 1.8 * (at / 3 - 1) + uniform(-0.2, 0.2), 0);
    T.linear() = Eigen::AngleAxisd(uniform(0, 2 * M_PI), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    add(mesh, T);
    return T;
  }

  /// From the middle, and so many more places beside the walls.
  BrickMap scan(int more) {
    BrickMasks occupied, free;
    std::vector<Eigen::Vector3d> scanners{{uniform(-0.3, 0.3), uniform(-0.3, 0.3), uniform(0.5, 1.4)}};
    for (int i = 0; i < more; ++i) {
      const double angle = uniform(0, 2 * M_PI);
      scanners.emplace_back(2.6 * std::cos(angle), 2.6 * std::sin(angle), uniform(0.5, 1.4));
    }
    std::normal_distribution<double> noise(0, 0.01);
    for (const Eigen::Vector3d& from : scanners) {
      for (double up = -60; up <= 45; up += 0.8) {
        for (double around = 0; around < 360; around += 0.8) look(from, direction(up, around), noise, occupied, free);
      }
    }
    free.erase(occupied);
    BrickMap map = occupied.to_map(kOccupied);
    for (const auto& [index, mask] : free.sorted()) {
      DenseBrick dense;
      dense.fill(kUnknown);
      if (const Brick* there = map.find(index)) there->to_dense(dense);
      for (std::size_t i = 0; i < dense.size(); ++i) {
        if ((mask[i / 64] >> (i % 64) & 1) != 0) dense[i] = kFree;
      }
      map.set(index, Brick::from_dense(dense));
    }
    return map;
  }

 private:
  void add(const TriangleMesh& mesh, const Transform& T) {
    solid_.insert(voxelize(mesh, {T, 1.0}, kResolution, Fill::kSurface)->surface);
  }
  static Eigen::Vector3d direction(double up, double around) {
    const double e = up * M_PI / 180, a = around * M_PI / 180;
    return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
  }
  void look(const Eigen::Vector3d& from, const Eigen::Vector3d& way, std::normal_distribution<double>& noise,
            BrickMasks& occupied, BrickMasks& free) {
    double far = 0;
    while (far < 10 && !solid_.contains(voxel_of(from + way * far, kResolution))) far += 0.01;
    const Eigen::Vector3d hit = from + way * (far + noise(random_));
    walk_ray(from / kResolution, hit / kResolution, [&](VoxelIndex v) { free.insert(v); });
    occupied.insert(voxel_of(hit, kResolution));
  }

  std::mt19937 random_;
  BrickMasks solid_;
  std::vector<int> places_{0, 1, 2, 3, 5, 6, 7, 8};  // not the middle one
  std::size_t next_ = 0;
};

struct Tally {
  int there = 0, found = 0, wrong = 0;
};

/// Every other room has one of what is sought; all have four other things.
Tally search(const TriangleMesh& sought, const TriangleMesh& other, int more_looks, unsigned rooms) {
  Tally tally;
  for (unsigned seed = 0; seed < rooms; ++seed) {
    Room room(seed);
    const bool has = seed % 2 == 0;
    const Transform T = has ? room.place(sought) : Transform::Identity();
    room.place(other);
    room.place(table());
    for (int i = 0; i < 2; ++i) {
      const double width = room.uniform(0.25, 0.45), depth = room.uniform(0.15, 0.45);
      room.place(box_mesh({-width, -depth, 0}, {width, depth, room.uniform(0.4, 1.2)}));
    }
    const auto found = find_model(sought, 1.0, room.scan(more_looks), kResolution);
    tally.there += has ? 1 : 0;
    for (const FoundModel& one : found.value()) {
      const double off = (one.T_map_model.translation() - T.translation()).norm();
      const double turned = Eigen::AngleAxisd(T.linear().transpose() * one.T_map_model.linear()).angle();
      ++(has && off < 0.15 && turned < 0.3 ? tally.found : tally.wrong);
    }
  }
  return tally;
}

TEST(FindModelInScans, APumpSeenFromOnePlaceIsFoundAndNothingElseIsTakenForOne) {
  const Tally tally = search(pump_mesh(), chair(), 0, 16);
  EXPECT_GE(tally.found, tally.there / 2) << "some hide behind other things";
  EXPECT_EQ(tally.wrong, 0);
}

TEST(FindModelInScans, AChairSeenFromThreePlacesIsFoundAndNothingElseIsTakenForOne) {
  const Tally tally = search(chair(), pump_mesh(), 2, 8);
  EXPECT_GE(tally.found, tally.there * 3 / 4);
  EXPECT_EQ(tally.wrong, 0);
}

}  // namespace
}  // namespace concord
