#include "core/octomap_writer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <optional>
#include <span>

namespace concord {
namespace {

constexpr int kBrickLevel = 3;
constexpr std::int32_t kBrickOrigin = kOctomapOrigin / kBrickSide;
constexpr std::int32_t kAxisBricks = -2 * kBrickOrigin;

/// A brick and its place in the order in which OctoMap writes: the bits of x, y and z interleaved, x lowest.
struct PlacedBrick {
  std::uint64_t place;
  const Brick* brick;
};
using PlacedBricks = std::span<const PlacedBrick>;

constexpr std::uint64_t spread(std::uint64_t bits) {
  std::uint64_t result = 0;
  for (int i = 0; bits >> i != 0; ++i) result |= (bits >> i & 1) << (3 * i);
  return result;
}

constexpr std::uint64_t interleaved(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

/// Voxel of a brick (x fastest) for each place in OctoMap's order.
constexpr std::array<std::uint16_t, kBrickVoxels> kVoxelAt = [] {
  std::array<std::uint16_t, kBrickVoxels> table{};
  for (std::uint32_t local = 0; local < kBrickVoxels; ++local) {
    table[interleaved(local & 7, local >> 3 & 7, local >> 6)] = static_cast<std::uint16_t>(local);
  }
  return table;
}();

Result<std::vector<PlacedBrick>> placed(const BrickMap& map) {
  std::vector<PlacedBrick> bricks;
  bricks.reserve(map.brick_count());
  bool inside = true;
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    const auto key = [&](std::int32_t i) {
      inside = inside && i >= kBrickOrigin && i < kBrickOrigin + kAxisBricks;
      return static_cast<std::uint32_t>(i - kBrickOrigin);
    };
    const std::uint64_t place = interleaved(key(index.x), key(index.y), key(index.z));
    bricks.push_back({place, &brick});
  });
  if (!inside) {
    return refuse(Code::kOutOfBounds, "map has voxels beyond index +-32768, which no OctoMap holds; save a part of it");
  }
  std::sort(bricks.begin(), bricks.end(), [](const auto& a, const auto& b) { return a.place < b.place; });
  return bricks;
}

/// What a subtree turned out to be: nothing, one leaf, or inner nodes below which the largest value is `value`.
struct Subtree {
  enum class Kind { kUnknown, kLeaf, kInner } kind = Kind::kUnknown;
  LogOdds value = kUnknown;
};
using Children = std::array<Subtree, 8>;

/// Nodes of a `.bt`: an inner node says what its children are, so that leaves have no bytes of their own.
struct BinaryNodes {
  static constexpr std::size_t kInnerBytes = 2;

  static LogOdds leaf_value(LogOdds l) { return is_occupied(l) ? kOccupied : kFree; }
  static void append_leaf(Bytes&, LogOdds) {}
  static void complete_inner(std::uint8_t* at, LogOdds, const Children& children) {
    unsigned codes = 0;  // two bits a child: 0 unknown, 1 free, 2 occupied, 3 inner
    for (int i = 0; i < 8; ++i) {
      const Subtree& child = children[i];
      if (child.kind == Subtree::Kind::kUnknown) continue;
      const unsigned leaf = is_occupied(child.value) ? 2 : 1;
      codes |= (child.kind == Subtree::Kind::kInner ? 3 : leaf) << (2 * i);
    }
    at[0] = static_cast<std::uint8_t>(codes);
    at[1] = static_cast<std::uint8_t>(codes >> 8);
  }
};

/// Nodes of a `.ot`: log-odds as a float and a bit for each child; an inner node has the largest value below it.
struct FullNodes {
  static constexpr std::size_t kInnerBytes = 5;

  static LogOdds leaf_value(LogOdds l) { return l; }
  static void append_leaf(Bytes& out, LogOdds l) {
    out.resize(out.size() + kInnerBytes);
    complete_inner(&out[out.size() - kInnerBytes], l, {});
  }
  static void complete_inner(std::uint8_t* at, LogOdds largest, const Children& children) {
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(to_double(largest)));
    for (unsigned i = 0; i < 4; ++i) at[i] = static_cast<std::uint8_t>(bits >> (8 * i));
    unsigned present = 0;
    for (int i = 0; i < 8; ++i) present |= unsigned{children[i].kind != Subtree::Kind::kUnknown} << i;
    at[4] = static_cast<std::uint8_t>(present);
  }
};

/// Appends a tree depth first. A node is written before its children and completed after them.
template <class Nodes>
class TreeWriter {
 public:
  explicit TreeWriter(Bytes& out) : out_(out) {}

  void write(PlacedBricks bricks) { brick_node(bricks, kOctomapDepth); }

  [[nodiscard]] std::uint64_t nodes() const { return nodes_; }

 private:
  using Kind = Subtree::Kind;

  /// The node of `level` that holds `bricks`, all of which lie in it.
  Subtree brick_node(PlacedBricks bricks, int level) {
    if (bricks.empty()) return {};
    if (level == kBrickLevel) return brick(*bricks.front().brick);
    const int shift = 3 * (level - 1 - kBrickLevel);
    return inner_node([&](int child) {
      const auto end = std::partition_point(bricks.begin(), bricks.end(), [&](const PlacedBrick& b) {
        return static_cast<int>(b.place >> shift & 7) <= child;
      });
      const auto count = static_cast<std::size_t>(end - bricks.begin());
      const PlacedBricks of_child = bricks.first(count);
      bricks = bricks.subspan(count);
      return brick_node(of_child, level - 1);
    });
  }

  Subtree brick(const Brick& brick) {
    if (brick.is_uniform() && brick.known_count() == kBrickVoxels) return leaf(brick.uniform_value());
    DenseBrick dense;
    brick.to_dense(dense);
    for (int place = 0; place < kBrickVoxels; ++place) ordered_[place] = dense[kVoxelAt[place]];
    return voxel_node(0, kBrickVoxels);
  }

  /// The node that holds `size` voxels from `place` on.
  Subtree voxel_node(int place, int size) {
    if (size == 1) return is_known(ordered_[place]) ? leaf(ordered_[place]) : Subtree{};
    const auto begin = ordered_.begin() + place;
    if (std::all_of(begin, begin + size, [](LogOdds l) { return !is_known(l); })) return {};
    return inner_node([&](int child) { return voxel_node(place + child * size / 8, size / 8); });
  }

  Subtree leaf(LogOdds l) {
    ++nodes_;
    const LogOdds value = Nodes::leaf_value(l);
    Nodes::append_leaf(out_, value);
    return {Kind::kLeaf, value};
  }

  /// `make_child(i)` appends child i and says what it is; it is called for each i in order.
  template <class MakeChild>
  Subtree inner_node(MakeChild&& make_child) {
    const std::size_t at = out_.size();
    const std::uint64_t nodes_before = nodes_;
    out_.resize(at + Nodes::kInnerBytes);
    Children children;
    for (int i = 0; i < 8; ++i) children[i] = make_child(i);
    if (is_one_leaf(children)) {
      out_.resize(at);
      nodes_ = nodes_before;
      return leaf(children[0].value);
    }
    ++nodes_;
    const auto lower = [](const Subtree& a, const Subtree& b) { return a.value < b.value; };
    const LogOdds largest = std::max_element(children.begin(), children.end(), lower)->value;
    Nodes::complete_inner(&out_[at], largest, children);
    return {Kind::kInner, largest};
  }

  static bool is_one_leaf(const Children& children) {
    return std::all_of(children.begin(), children.end(), [&](const Subtree& child) {
      return child.kind == Kind::kLeaf && child.value == children[0].value;
    });
  }

  Bytes& out_;
  DenseBrick ordered_;
  std::uint64_t nodes_ = 0;
};

/// Appends the tree of `map` and answers its number of nodes.
Result<std::uint64_t> append_tree(Bytes& out, const BrickMap& map, OctomapFormat format) {
  const Result<std::vector<PlacedBrick>> bricks = placed(map);
  if (!bricks) return tl::unexpected(bricks.error());
  const auto append = [&](auto writer) {
    writer.write(*bricks);
    return writer.nodes();
  };
  return format == OctomapFormat::kBinary ? append(TreeWriter<BinaryNodes>(out)) : append(TreeWriter<FullNodes>(out));
}

}  // namespace

Result<Bytes> write_octomap_data(const BrickMap& map, OctomapFormat format) {
  Bytes bytes;
  const Result<std::uint64_t> nodes = append_tree(bytes, map, format);
  if (!nodes) return tl::unexpected(nodes.error());
  return bytes;
}

Result<Bytes> write_octomap_file(const BrickMap& map, double resolution, OctomapFormat format) {
  const Result<double> checked = checked_resolution(resolution);
  if (!checked) return tl::unexpected(checked.error());
  Bytes tree;
  const Result<std::uint64_t> nodes = append_tree(tree, map, format);
  if (!nodes) return tl::unexpected(nodes.error());
  Bytes file;
  append_octomap_header(file, {format, *nodes, *checked});
  file.insert(file.end(), tree.begin(), tree.end());
  return file;
}

}  // namespace concord
