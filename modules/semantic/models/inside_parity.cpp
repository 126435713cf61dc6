#include <algorithm>

#include "semantic/models/exact_range.hpp"
#include "semantic/models/solid_voxels.hpp"
#include "semantic/models/triangle_voxels.hpp"

namespace concord {
namespace {

constexpr std::int64_t kHalf = kSnap / 2;
constexpr std::int64_t kShift = kMaxVoxel;  ///< makes indices positive
constexpr int kIndexBits = 17;

/// Where the vertical line through a column's centres crosses a triangle: at or below the centre of voxel z, and above
/// that of z - 1. Ordered by column, then z.
std::uint64_t crossing(std::int64_t x, std::int64_t y, std::int64_t z) {
  const auto part = [](std::int64_t c) { return static_cast<std::uint64_t>(c + kShift); };
  return (part(x) << kIndexBits | part(y)) << kIndexBits | part(z);
}
std::int32_t index_in(std::uint64_t crossing, int field) {
  return static_cast<std::int32_t>(
      static_cast<std::int64_t>(crossing >> (field * kIndexBits) & ((1U << kIndexBits) - 1)) - kShift);
}

/// A line through the centres of column (x, y) lies left of an edge of the triangle, seen from above with its corners
/// counted against the clock. A line that meets an edge counts as if it stood a little further on x and, far less, on
/// y: so it is on one side of each edge, and the same side whichever triangle asks.
class LeftOfEdge {
 public:
  LeftOfEdge(const Snapped& from, const Snapped& to) : from_(from), ex_(to[0] - from[0]), ey_(to[1] - from[1]) {
    wins_ties_ = ey_ < 0 || (ey_ == 0 && ex_ > 0);
  }

  /// The y of the columns (x, y) for this x.
  [[nodiscard]] IntRange of(std::int64_t x) const {
    // ex (py - from.y) - ey (px - from.x) > 0, or >= 0; py = y kSnap + kHalf.
    const Int128 at = Int128{ex_} * (kHalf - from_[1]) - Int128{ey_} * (x * kSnap + kHalf - from_[0]);
    const Int128 least = ceil_div<Int128>((wins_ties_ ? 0 : 1) - at, kSnap);
    return solve<Int128>(least, Int128{1} << 120, 0, ex_);
  }

 private:
  Snapped from_;
  std::int64_t ex_, ey_;
  bool wins_ties_;
};

class Crossings {
 public:
  /// Refused: more columns than a model may have.
  [[nodiscard]] Result<void> add(std::array<Snapped, 3> c) {
    const Int128 turn =
        Int128{c[1][0] - c[0][0]} * (c[2][1] - c[0][1]) - Int128{c[1][1] - c[0][1]} * (c[2][0] - c[0][0]);
    if (turn == 0) return {};  // upright: no line that stands a little aside crosses it
    if (turn < 0) std::swap(c[1], c[2]);
    const auto [low, high] = std::minmax({c[0][0], c[1][0], c[2][0]});
    const std::array<LeftOfEdge, 3> edges{LeftOfEdge(c[0], c[1]), LeftOfEdge(c[1], c[2]), LeftOfEdge(c[2], c[0])};
    const Heights heights(c);
    for (std::int64_t x = floor_div(low - kHalf, kSnap); x * kSnap + kHalf <= high; ++x) {
      const IntRange ys = edges[0].of(x) & edges[1].of(x) & edges[2].of(x);
      if (ys.empty()) continue;
      if (ys.last - ys.first >= kMaxModelColumns / 4 - static_cast<std::int64_t>(all_.size())) {
        return refuse(Code::kTooLarge, "the model's inside spans too many columns of voxels; is its unit right?");
      }
      for (std::int64_t y = ys.first; y <= ys.last; ++y) all_.push_back(crossing(x, y, heights.first_above(x, y)));
    }
    return {};
  }

  /// Refused: over kMaxModelVoxels.
  [[nodiscard]] Result<BrickMasks> filled() && {
    std::ranges::sort(all_);
    std::int64_t voxels = 0;
    for (std::size_t i = 0; i + 1 < all_.size(); i += 2) voxels += index_in(all_[i + 1], 0) - index_in(all_[i], 0);
    if (voxels > kMaxModelVoxels) {
      return refuse(Code::kTooLarge, "the model would fill over " + std::to_string(kMaxModelVoxels) + " voxels");
    }
    BrickMasks out;
    for (std::size_t i = 0; i + 1 < all_.size(); i += 2) {
      out.insert_column(index_in(all_[i], 2), index_in(all_[i], 1), index_in(all_[i], 0), index_in(all_[i + 1], 0) - 1);
    }
    return out;
  }

 private:
  /// How high the triangle stands above each column.
  class Heights {
   public:
    explicit Heights(const std::array<Snapped, 3>& c) : from_(c[0]) {
      const auto edge = [&](int corner, int axis) { return Int128{c[corner][axis] - c[0][axis]}; };
      for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        normal_[axis] = edge(1, u) * edge(2, v) - edge(1, v) * edge(2, u);  // z: positive, see `add`
      }
    }
    /// The lowest voxel whose centre is not below the triangle.
    [[nodiscard]] std::int64_t first_above(std::int64_t x, std::int64_t y) const {
      const Int128 dx = x * kSnap + kHalf - from_[0], dy = y * kSnap + kHalf - from_[1];
      const Int128 height = normal_[2] * (from_[2] - kHalf) - normal_[0] * dx - normal_[1] * dy;
      return static_cast<std::int64_t>(ceil_div<Int128>(height, normal_[2] * kSnap));
    }

   private:
    Snapped from_;
    std::array<Int128, 3> normal_{};
  };

  std::vector<std::uint64_t> all_;
};

}  // namespace

/// @pre is_watertight(mesh): so every column is crossed an even number of times.
Result<BrickMasks> inside_by_parity(const SnappedMesh& mesh) {
  Crossings crossings;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (const auto added = crossings.add(corners_of(mesh, i)); !added) return tl::unexpected(added.error());
  }
  return std::move(crossings).filled();
}

}  // namespace concord
