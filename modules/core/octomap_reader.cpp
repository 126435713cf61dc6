#include "core/octomap_reader.hpp"

#include <string>

#include "core/octree_walk.hpp"
#include "core/resample.hpp"

namespace concord {
namespace {

constexpr int kBrickLevel = 3;  // a brick is 2^3 voxels a side, and a node of that level in OctoMap's lattice

/// What a tree would take if it were built.
struct Extent {
  std::uint64_t nodes = 0;
  std::uint64_t voxels = 0;
  std::uint64_t bricks = 0;
};

Result<Extent> measure(ByteSpan bytes, OctomapFormat format, const OctomapLimits& limits) {
  Extent extent;
  std::optional<BrickIndex> last;
  const auto count = [&](const OctreeLeaf& leaf) {
    extent.voxels += std::uint64_t{1} << (3 * leaf.level);
    if (leaf.level >= kBrickLevel) {
      extent.bricks += std::uint64_t{1} << (3 * (leaf.level - kBrickLevel));
    } else if (const BrickIndex brick = brick_of(leaf.origin); last != brick) {
      ++extent.bricks;
      last = brick;
    }
    return extent.voxels <= limits.known_voxels && extent.bricks <= limits.bricks;
  };
  const Result<std::uint64_t> nodes = OctreeWalk(bytes, format, count).run();
  if (!nodes) return tl::unexpected(nodes.error());
  if (extent.voxels > limits.known_voxels || extent.bricks > limits.bricks) {
    return refuse(Code::kTooLarge, "OctoMap tree covers more than " + std::to_string(limits.known_voxels) +
                                       " voxels or " + std::to_string(limits.bricks) + " bricks; send a smaller part");
  }
  extent.nodes = *nodes;
  return extent;
}

/// Gathers the leaves of a walk into bricks. Each brick is complete before the next one begins.
class BrickBuilder {
 public:
  void add(const OctreeLeaf& leaf) {
    if (leaf.level >= kBrickLevel) {
      add_cube(leaf);
    } else {
      add_part(leaf);
    }
  }

  [[nodiscard]] BrickMap take() {
    finish_brick();
    return std::move(map_);
  }

 private:
  void add_cube(const OctreeLeaf& leaf) {
    VoxelMask all;
    all.fill(~std::uint64_t{0});
    const BrickIndex low = brick_of(leaf.origin);
    const std::int32_t side = 1 << (leaf.level - kBrickLevel);
    for (std::int32_t z = 0; z < side; ++z) {
      for (std::int32_t y = 0; y < side; ++y) {
        for (std::int32_t x = 0; x < side; ++x) {
          map_.set({low.x + x, low.y + y, low.z + z}, Brick::uniform(all, leaf.value));
        }
      }
    }
  }

  void add_part(const OctreeLeaf& leaf) {
    const BrickIndex brick = brick_of(leaf.origin);
    if (current_ != brick) {
      finish_brick();
      current_ = brick;
      dense_.fill(kUnknown);
    }
    const int low = local_of(leaf.origin);
    const int side = 1 << leaf.level;
    for (int z = 0; z < side; ++z) {
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) dense_[low + (z * 64 + y * 8 + x)] = leaf.value;
      }
    }
  }

  void finish_brick() {
    if (current_) map_.set(*current_, Brick::from_dense(dense_));
    current_.reset();
  }

  BrickMap map_;
  std::optional<BrickIndex> current_;
  DenseBrick dense_;
};

tl::unexpected<Error> too_many_bytes(const OctomapLimits& limits) {
  return refuse(Code::kTooLarge, "OctoMap is over " + std::to_string(limits.bytes) + " bytes; send a smaller part");
}

/// `expected_nodes`: what a header said; absent: there was none.
Result<OctomapImport> read_tree(ByteSpan bytes, OctomapFormat format, double resolution,
                                std::optional<std::uint64_t> expected_nodes, std::optional<double> target_resolution,
                                const OctomapLimits& limits) {
  BrickMap map;
  const bool has_tree = expected_nodes ? *expected_nodes != 0 : !bytes.empty();
  if (has_tree) {
    const Result<Extent> extent = measure(bytes, format, limits);
    if (!extent) return tl::unexpected(extent.error());
    if (expected_nodes.value_or(extent->nodes) != extent->nodes) {
      return refuse(Code::kMalformed, "OctoMap header says " + std::to_string(*expected_nodes) +
                                          " nodes, the tree has " + std::to_string(extent->nodes) +
                                          "; the file is damaged");
    }
    BrickBuilder builder;
    const auto build = [&](const OctreeLeaf& leaf) { return builder.add(leaf), true; };
    const Result<std::uint64_t> nodes = OctreeWalk(bytes, format, build).run();
    if (!nodes) return tl::unexpected(nodes.error());
    map = builder.take();
  } else if (!bytes.empty()) {
    return refuse(Code::kMalformed, "OctoMap header says that there is no tree, but bytes follow");
  }
  if (!target_resolution || same_resolution(resolution, *target_resolution)) {
    return OctomapImport{std::move(map), target_resolution.value_or(resolution)};
  }
  Result<BrickMap> resampled = resample(map, resolution, *target_resolution, limits.bricks);
  if (!resampled) return tl::unexpected(resampled.error());
  return OctomapImport{std::move(*resampled), *target_resolution};
}

}  // namespace

Result<OctomapImport> read_octomap_file(ByteSpan bytes, std::optional<double> target_resolution,
                                        const OctomapLimits& limits) {
  if (bytes.size() > limits.bytes) return too_many_bytes(limits);
  const Result<OctomapHeader> header = read_octomap_header(bytes);
  if (!header) return tl::unexpected(header.error());
  return read_tree(bytes, header->format, header->resolution, header->nodes, target_resolution, limits);
}

Result<OctomapImport> read_octomap_data(ByteSpan bytes, OctomapFormat format, double resolution,
                                        std::optional<double> target_resolution, const OctomapLimits& limits) {
  if (bytes.size() > limits.bytes) return too_many_bytes(limits);
  const Result<double> checked = checked_resolution(resolution);
  if (!checked) return tl::unexpected(checked.error());
  return read_tree(bytes, format, *checked, std::nullopt, target_resolution, limits);
}

}  // namespace concord
