#include "core/resample.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <string>
#include <vector>

#include "core/decimal.hpp"

namespace concord {
namespace {

/// Half-open, on one axis.
struct Range {
  std::int32_t begin, end;
};

/// How a fine lattice lies in a coarse one, on one axis: each fine cell belongs to the coarse cell that holds its
/// centre.
class Nesting {
 public:
  Nesting(double a, double b) : ratio_(std::min(a, b) / std::max(a, b)) {}

  [[nodiscard]] double ratio() const { return ratio_; }

  /// A centre on a boundary belongs to the cell above, however `ratio_` was rounded.
  [[nodiscard]] std::int32_t coarse_of(std::int32_t fine) const {
    const double position = (fine + 0.5) * ratio_;
    const double nearest = std::round(position);
    return static_cast<std::int32_t>(std::abs(position - nearest) < 1e-7 ? nearest : std::floor(position));
  }
  [[nodiscard]] Range coarse_bricks(std::int32_t fine_brick) const {
    return {coarse_of(fine_brick * kBrickSide) >> 3, (coarse_of(fine_brick * kBrickSide + 7) >> 3) + 1};
  }
  [[nodiscard]] Range fine_bricks(std::int32_t coarse_brick) const {
    return {first_in(coarse_brick * kBrickSide) >> 3, ((first_in((coarse_brick + 1) * kBrickSide) - 1) >> 3) + 1};
  }

 private:
  /// The lowest fine cell that belongs to `coarse` or a cell above it.
  [[nodiscard]] std::int32_t first_in(std::int32_t coarse) const {
    auto fine = static_cast<std::int32_t>(std::floor(coarse / ratio_ - 0.5));
    while (coarse_of(fine) >= coarse) --fine;
    while (coarse_of(fine) < coarse) ++fine;
    return fine;
  }

  double ratio_;
};

struct Box {
  Range x, y, z;
};

template <class Visit>
void for_each_in(const Box& box, Visit&& visit) {
  for (std::int32_t z = box.z.begin; z < box.z.end; ++z) {
    for (std::int32_t y = box.y.begin; y < box.y.end; ++y) {
      for (std::int32_t x = box.x.begin; x < box.x.end; ++x) visit(BrickIndex{x, y, z});
    }
  }
}

double volume(const Box& box) {
  return 1.0 * (box.x.end - box.x.begin) * (box.y.end - box.y.begin) * (box.z.end - box.z.begin);
}

/// For each voxel of a fine brick on one axis: its place in a coarse brick, -1 where it belongs to another.
using AxisPlaces = std::array<int, kBrickSide>;

AxisPlaces places(const Nesting& nesting, std::int32_t fine_brick, std::int32_t coarse_brick) {
  AxisPlaces result;
  for (int i = 0; i < kBrickSide; ++i) {
    const std::int32_t coarse = nesting.coarse_of(fine_brick * kBrickSide + i);
    result[i] = coarse >> 3 == coarse_brick ? coarse & 7 : -1;
  }
  return result;
}

struct Places {
  Places(const Nesting& nesting, BrickIndex fine, BrickIndex coarse)
      : x(places(nesting, fine.x, coarse.x)),
        y(places(nesting, fine.y, coarse.y)),
        z(places(nesting, fine.z, coarse.z)) {}

  /// The voxel of the coarse brick that voxel `local` of the fine one belongs to, or -1.
  [[nodiscard]] int coarse_of(int local) const {
    const int px = x[local & 7], py = y[local >> 3 & 7], pz = z[local >> 6];
    return (px | py | pz) < 0 ? -1 : px | py << 3 | pz << 6;
  }

  AxisPlaces x, y, z;
};

class Resampler {
 public:
  Resampler(const BrickMap& map, double source, double target)
      : map_(map), nesting_(source, target), to_coarser_(source < target) {}

  /// Whether all target indices are in bounds.
  [[nodiscard]] bool stays_in_bounds() const {
    if (to_coarser_) return true;
    bool inside = true;
    map_.for_each_brick([&](BrickIndex b, const Brick&) {
      const double furthest = std::max({std::abs(b.x + 0.5), std::abs(b.y + 0.5), std::abs(b.z + 0.5)}) + 0.5;
      inside = inside && (furthest * kBrickSide) / nesting_.ratio() < kMaxVoxel - kBrickSide;
    });
    return inside;
  }

  /// Pairs of a source brick and a target brick that it may give voxels to. At most 8 for each of the finer ones.
  [[nodiscard]] double pairs() const {
    double count = 0;
    map_.for_each_brick([&](BrickIndex brick, const Brick&) { count += volume(targets_of(brick)); });
    return count;
  }

  [[nodiscard]] std::vector<BrickIndex> targets() const {
    std::vector<BrickIndex> bricks;
    map_.for_each_brick([&](BrickIndex brick, const Brick&) {
      for_each_in(targets_of(brick), [&](BrickIndex target) { bricks.push_back(target); });
    });
    std::sort(bricks.begin(), bricks.end());
    bricks.erase(std::unique(bricks.begin(), bricks.end()), bricks.end());
    return bricks;
  }

  [[nodiscard]] Brick make(BrickIndex target) const {
    DenseBrick dense;
    dense.fill(kUnknown);
    for_each_in(sources_of(target), [&](BrickIndex index) {
      if (const Brick* source = map_.find(index)) {
        if (to_coarser_) {
          raise(*source, Places(nesting_, index, target), dense);
        } else {
          look_up(*source, Places(nesting_, target, index), dense);
        }
      }
    });
    return Brick::from_dense(dense);
  }

 private:
  [[nodiscard]] Box coarse_bricks(BrickIndex b) const {
    return {nesting_.coarse_bricks(b.x), nesting_.coarse_bricks(b.y), nesting_.coarse_bricks(b.z)};
  }
  [[nodiscard]] Box fine_bricks(BrickIndex b) const {
    return {nesting_.fine_bricks(b.x), nesting_.fine_bricks(b.y), nesting_.fine_bricks(b.z)};
  }
  [[nodiscard]] Box targets_of(BrickIndex b) const { return to_coarser_ ? coarse_bricks(b) : fine_bricks(b); }
  [[nodiscard]] Box sources_of(BrickIndex b) const { return to_coarser_ ? fine_bricks(b) : coarse_bricks(b); }

  static void raise(const Brick& fine, const Places& places, DenseBrick& coarse) {
    fine.for_each([&](int local, LogOdds l) {
      // Unknown is the lowest value of all, so that any known one replaces it.
      if (const int place = places.coarse_of(local); place >= 0) coarse[place] = std::max(coarse[place], l);
    });
  }

  static void look_up(const Brick& coarse, const Places& places, DenseBrick& fine) {
    DenseBrick values;
    coarse.to_dense(values);
    for (int local = 0; local < kBrickVoxels; ++local) {
      if (const int place = places.coarse_of(local); place >= 0) fine[local] = values[place];
    }
  }

  const BrickMap& map_;
  Nesting nesting_;
  bool to_coarser_;
};

}  // namespace

bool same_resolution(double a, double b) { return std::abs(a - b) <= kSameResolution * std::max(a, b); }

Result<BrickMap> resample(const BrickMap& map, double source, double target, std::uint64_t max_bricks,
                          const std::stop_token& stop) {
  assert(source > 0 && target > 0);
  const auto too_large = [&] {
    return refuse(Code::kTooLarge, "map at " + decimal(target) + " m has more than " + std::to_string(max_bricks) +
                                       " bricks; use a coarser resolution");
  };
  const Resampler resampler(map, source, target);
  if (!resampler.stays_in_bounds()) {
    return refuse(Code::kOutOfBounds,
                  "map at " + decimal(target) + " m has voxel indices beyond 2^20; use a coarser resolution");
  }
  // No target is in more than 8 pairs unless it is coarser, and then there are at most 8 pairs a source brick.
  if (resampler.pairs() > 8.0 * static_cast<double>(std::max<std::uint64_t>(max_bricks, map.brick_count()))) {
    return too_large();
  }
  const std::vector<BrickIndex> targets = resampler.targets();
  if (targets.size() > max_bricks) return too_large();
  BrickMap result;
  for (const BrickIndex index : targets) {
    if (stop.stop_requested()) break;
    result.set(index, resampler.make(index));
  }
  return result;
}

}  // namespace concord
