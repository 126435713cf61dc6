#include "core/tile_puller.hpp"

#include <algorithm>
#include <cmath>

namespace concord {
namespace {

constexpr double kRoundingMargin = 0.01;  // voxels

Eigen::Vector3d to_vector(VoxelIndex v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

Eigen::Vector3d first_voxel(TileIndex tile) { return to_vector(origin_of(origin_of(tile))); }

FixedPoint to_fixed(const Eigen::Vector3d& p) {
  FixedPoint out;
  for (int axis = 0; axis < 3; ++axis) {
    out[axis] = static_cast<std::int32_t>(std::lround(std::ldexp(p[axis], kFractionBits)));
  }
  return out;
}

FixedPoint sum(const FixedPoint& a, const FixedPoint& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

FixedPoint combine(const std::array<FixedPoint, 3>& steps, int x, int y, int z) {
  FixedPoint out;
  for (int axis = 0; axis < 3; ++axis) out[axis] = x * steps[0][axis] + y * steps[1][axis] + z * steps[2][axis];
  return out;
}

int cell_at(BrickIndex position) {
  return (position.x + position.y * SourceBox::kRow + position.z * SourceBox::kPlane) * kBrickSide;
}

// The least box that holds a set of a tile's bricks: positions 0 to 3, both ends included.
struct BrickBox {
  BrickIndex low, high;
};

BrickBox box_of(std::uint64_t bricks) {
  constexpr std::array<std::uint64_t, 3> kSlices{0x1111111111111111, 0x000F000F000F000F, 0x000000000000FFFF};
  constexpr std::array<int, 3> kStrides{1, 4, 16};
  std::array<std::array<int, 2>, 3> ends{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto has = [&](int i) { return (bricks & kSlices[axis] << (i * kStrides[axis])) != 0; };
    int low = 0;
    int high = kTileSide - 1;
    while (low < high && !has(low)) ++low;
    while (high > low && !has(high)) --high;
    ends[axis] = {low, high};
  }
  return {{ends[0][0], ends[1][0], ends[2][0]}, {ends[0][1], ends[1][1], ends[2][1]}};
}

// Calls `visit(BrickIndex, const Brick&)` for the map's bricks from `low` to `high`, both included.
template <class Visit>
void visit_bricks(const BrickMap& map, BrickIndex low, BrickIndex high, Visit&& visit) {
  const TileIndex first = tile_of(low);
  const TileIndex last = tile_of(high);
  const auto from = [](std::int32_t bound, std::int32_t tile) { return std::max(bound - tile * kTileSide, 0); };
  const auto to = [](std::int32_t bound, std::int32_t tile) {
    return std::min(bound - tile * kTileSide, kTileSide - 1);
  };
  for (std::int32_t z = first.z; z <= last.z; ++z) {
    for (std::int32_t y = first.y; y <= last.y; ++y) {
      for (std::int32_t x = first.x; x <= last.x; ++x) {
        const TileIndex index{x, y, z};
        const Tile* tile = map.find(index);
        if (tile == nullptr) continue;
        const std::uint64_t inside =
            tile_box({from(low.x, x), from(low.y, y), from(low.z, z)}, {to(high.x, x), to(high.y, y), to(high.z, z)});
        const Brick* brick = tile->bricks.data();
        for (std::uint64_t bits = tile->present; bits != 0; bits &= bits - 1, ++brick) {
          const int local = std::countr_zero(bits);
          if ((inside >> local & 1) != 0) visit(brick_at(index, local), *brick);
        }
      }
    }
  }
}

// A point of the map, in voxels, relative to a tile's first corner. Rounded before the difference is taken, so that
// the fraction does not depend on the tile. @pre within 100 voxels of the tile.
FixedPoint push_origin(const Eigen::Vector3d& p, TileIndex tile) {
  const VoxelIndex corner = origin_of(origin_of(tile));
  const auto relative = [](double x, std::int32_t from) {
    const std::int64_t fixed = std::llround(std::ldexp(x, kFractionBits));
    return static_cast<std::int32_t>(fixed - (std::int64_t{from} << kFractionBits));
  };
  return {relative(p.x(), corner.x), relative(p.y(), corner.y), relative(p.z(), corner.z)};
}

// -1 outside the tile.
int brick_in_tile(const FixedPoint& p) {
  constexpr int kShift = kFractionBits + 3;
  const int x = p[0] >> kShift;
  const int y = p[1] >> kShift;
  const int z = p[2] >> kShift;
  return ((x | y | z) & ~(kTileSide - 1)) != 0 ? -1 : x | y << 2 | z << 4;
}

int voxel_in_brick(const FixedPoint& p) {
  const auto cell = [&](int axis) { return p[axis] >> kFractionBits & (kBrickSide - 1); };
  return cell(0) | cell(1) << 3 | cell(2) << 6;
}

// The bricks of a tile that a rotated source brick may reach; 0 if none.
std::uint64_t reach_of(const LatticeTransform& transform, TileIndex tile, BrickIndex source) {
  const Eigen::Vector3d middle = to_vector(origin_of(source)).array() + 0.5 * kBrickSide;
  const Eigen::Vector3d centre = transform.to_map(middle) - first_voxel(tile);
  const Eigen::Vector3d extent =
      transform.half_extent_in_map(Eigen::Vector3d::Constant(kBrickSide)).array() + kRoundingMargin;
  const BrickIndex low = brick_of(voxel_of(centre - extent, 1.0));
  const BrickIndex high = brick_of(voxel_of(centre + extent, 1.0));
  const auto misses = [](std::int32_t from, std::int32_t to) { return to < 0 || from >= kTileSide; };
  if (misses(low.x, high.x) || misses(low.y, high.y) || misses(low.z, high.z)) return 0;
  const auto clamp = [](std::int32_t i) { return std::clamp(i, 0, kTileSide - 1); };
  return tile_box({clamp(low.x), clamp(low.y), clamp(low.z)}, {clamp(high.x), clamp(high.y), clamp(high.z)});
}

// The cells whose centres, and the cells that hold the target centres, in a box of the map.
struct CellRange {
  BrickIndex low, high;  // bricks that hold them, both ends included
};

CellRange cells_under(const LatticeTransform& transform, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const Eigen::Vector3d centre = transform.to_layer(0.5 * (low + high));
  const Eigen::Vector3d extent = transform.half_extent_in_layer(high - low).array() + kRoundingMargin;
  const auto brick_at_centre = [](const Eigen::Vector3d& p) {
    return brick_of(voxel_of((p.array() - 0.5).matrix(), 1.0));
  };
  return {brick_at_centre(centre - extent), brick_at_centre(centre + extent)};
}

}  // namespace

TilePuller::TilePuller() : cells_(SourceBox::kCells), known_(SourceBox::kNearRows), near_(SourceBox::kNearRows) {}

void TilePuller::pull(const BrickMap& layer, const LatticeTransform& transform, TileIndex tile, std::uint64_t wanted,
                      LayerTile& out) {
  out.bricks = 0;
  out.is_whole = transform.brick_shift().has_value();
  if (out.is_whole) return take_whole(layer, *transform.brick_shift(), tile, wanted, out);
  const Region region = region_of(transform, tile, wanted);
  const std::uint64_t reach = find_sources(layer, transform, tile, wanted, region);
  if (reach == 0) return;
  out.keys.resize(kTileBricks);
  fill();
  brick_kernels().widen(known_.data(), near_.data(), low_plane_, high_plane_);
  const Eigen::Vector3d first = transform.to_layer((first_voxel(tile).array() + 0.5).matrix());
  const FixedPoint tile_origin = to_fixed(first - to_vector(origin_of(region.base)));
  for (std::uint64_t bits = reach; bits != 0; bits &= bits - 1) {
    const int local = std::countr_zero(bits);
    const VoxelIndex offset = origin_of(brick_at({}, local));
    const FixedPoint origin = sum(tile_origin, combine(transform.inverse_steps(), offset.x, offset.y, offset.z));
    if (brick_kernels().pull(cells_.data(), near_.data(), transform.pull_steps(), origin, out.keys[local].data())) {
      out.bricks |= std::uint64_t{1} << local;
    }
  }
  raise(transform, tile, wanted, out);
  clear();
}

void TilePuller::take_whole(const BrickMap& layer, BrickIndex shift, TileIndex tile, std::uint64_t wanted,
                            LayerTile& out) {
  const BrickIndex first = origin_of(tile);
  const BrickIndex source{first.x - shift.x, first.y - shift.y, first.z - shift.z};
  constexpr int kLast = kTileSide - 1;
  visit_bricks(layer, source, {source.x + kLast, source.y + kLast, source.z + kLast},
               [&](BrickIndex index, const Brick& brick) {
                 const int local = local_of(BrickIndex{index.x - source.x, index.y - source.y, index.z - source.z});
                 if ((wanted >> local & 1) == 0) return;
                 out.whole[local] = &brick;
                 out.bricks |= std::uint64_t{1} << local;
               });
}

TilePuller::Region TilePuller::region_of(const LatticeTransform& transform, TileIndex tile, std::uint64_t wanted) {
  const Eigen::Vector3d origin = first_voxel(tile);
  const BrickBox box = box_of(wanted);
  const CellRange whole = cells_under(transform, origin, (origin.array() + kTileVoxelSide).matrix());
  const CellRange part =
      cells_under(transform, origin + to_vector(origin_of(box.low)),
                  origin + to_vector(origin_of(BrickIndex{box.high.x + 1, box.high.y + 1, box.high.z + 1})));
  return {whole.low, part.low, part.high};
}

std::uint64_t TilePuller::find_sources(const BrickMap& layer, const LatticeTransform& transform, TileIndex tile,
                                       std::uint64_t wanted, const Region& region) {
  sources_.clear();
  std::uint64_t reach = 0;
  visit_bricks(layer, region.low, region.high, [&](BrickIndex index, const Brick& brick) {
    const std::uint64_t reached = reach_of(transform, tile, index) & wanted;
    if (reached == 0) return;
    reach |= reached;
    const BrickIndex position{index.x - region.base.x, index.y - region.base.y, index.z - region.base.z};
    sources_.push_back({&brick, index, position, {}});
  });
  return reach;
}

void TilePuller::fill() {
  low_plane_ = SourceBox::kSide;
  high_plane_ = 0;
  for (Source& source : sources_) {
    const Brick& brick = *source.brick;
    source.occupied = expand(brick, &cells_[cell_at(source.position)], SourceBox::kRow, SourceBox::kPlane);
    low_plane_ = std::min(low_plane_, source.position.z * kBrickSide);
    high_plane_ = std::max(high_plane_, (source.position.z + 1) * kBrickSide);
    for (int z = 0; z < kBrickSide; ++z) {
      std::uint64_t* rows = &known_[SourceBox::near_row(source.position.y * 8, source.position.z * 8 + z)];
      for (int y = 0; y < kBrickSide; ++y) {
        rows[y] |= (brick.known()[z] >> (8 * y) & 0xFF) << (8 * source.position.x);
      }
    }
  }
}

void TilePuller::raise(const LatticeTransform& transform, TileIndex tile, std::uint64_t wanted, LayerTile& out) const {
  // [position in a plane of the brick] a step from its first voxel.
  std::array<FixedPoint, 64> steps;
  for (int i = 0; i < 64; ++i) steps[i] = combine(transform.forward_steps(), i % 8, i / 8, 0);
  for (const Source& source : sources_) {
    if (source.occupied == VoxelMask{}) continue;
    const Eigen::Vector3d first = (to_vector(origin_of(source.index)).array() + 0.5).matrix();
    const FixedPoint brick_origin = push_origin(transform.to_map(first), tile);
    for (int z = 0; z < kBrickSide; ++z) {
      const FixedPoint origin = sum(brick_origin, combine(transform.forward_steps(), 0, 0, z));
      const Key* keys = &cells_[cell_at(source.position) + z * SourceBox::kPlane];
      for (std::uint64_t bits = source.occupied[z]; bits != 0; bits &= bits - 1) {
        const int i = std::countr_zero(bits);
        const FixedPoint p = sum(origin, steps[i]);
        const int brick = brick_in_tile(p);
        if (brick < 0 || (wanted >> brick & 1) == 0) continue;
        if ((out.bricks >> brick & 1) == 0) {
          out.keys[brick].fill(0);
          out.bricks |= std::uint64_t{1} << brick;
        }
        Key& key = out.keys[brick][voxel_in_brick(p)];
        key = std::max(key, keys[i % 8 + i / 8 * SourceBox::kRow]);
      }
    }
  }
}

void TilePuller::clear() {
  for (const Source& source : sources_) {
    Key* cells = &cells_[cell_at(source.position)];
    for (int z = 0; z < kBrickSide; ++z) {
      std::uint64_t* rows = &known_[SourceBox::near_row(source.position.y * 8, source.position.z * 8 + z)];
      std::fill_n(rows, kBrickSide, 0);
      for (int y = 0; y < kBrickSide; ++y) std::fill_n(cells + z * SourceBox::kPlane + y * SourceBox::kRow, 8, Key{0});
    }
  }
  // `widen` wrote to one plane on either side.
  const auto first = near_.begin() + SourceBox::near_row(-1, low_plane_ - 1);
  std::fill(first, first + (high_plane_ - low_plane_ + 2) * SourceBox::kNearRow, 0);
}

}  // namespace concord
