#include "align/wall_grid.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "align/workers.hpp"

namespace concord {
namespace {

constexpr float kMinWallHeight = 0.3F;   // metres: less is clutter or noise
constexpr float kFullWallHeight = 1.5F;  // metres: from here on a wall is a wall
constexpr float kLevelNormalZ = 0.7F;
constexpr float kLooseShare = 0.5F;  // what a cell that is no plane counts for
constexpr float kMinOpenHeight = 0.8F;

/// Cells of an image of 16 million at most: 400 x 400 m at 10 cm.
constexpr std::int64_t kMaxCells = 1 << 24;

using Cell = std::pair<std::int32_t, std::int32_t>;  // y, x

Eigen::Vector2i cell_at(const Eigen::Vector2f& p, double cell) {
  return (p.cast<double>() / cell).array().floor().cast<int>();
}

constexpr double kFarMetres = 5.0;

/// What to keep along one axis: from the first tenth to the last, and as much again on either side.
std::pair<float, float> near_range(std::vector<float> values) {
  const std::size_t tenth = values.size() / 10;
  std::nth_element(values.begin(), values.begin() + tenth, values.end());
  const float low = values[tenth];
  const std::size_t last = values.size() - 1 - tenth;
  std::nth_element(values.begin(), values.begin() + last, values.end());
  const float high = values[last];
  const float reach = std::max(high - low, static_cast<float>(kFarMetres));
  return {low - reach, high + reach};
}

Cell column_of(const Eigen::Vector3d& p, double cell) {
  const VoxelIndex v = voxel_of(p, cell);
  return {v.y, v.x};
}

}  // namespace

std::vector<WallColumn> wall_columns(const AlignMap& map, const Eigen::Matrix3d& R_upright_map, double cell) {
  struct Sum {
    Eigen::Vector2d p = Eigen::Vector2d::Zero();
    double weight = 0.0;
  };
  std::map<Cell, Sum> sums;
  const double area = map.fine().size() * map.fine().size();
  StopLook stop;
  for (const SurfaceCell& piece : map.fine().cells()) {
    stop.step();
    const bool flat = piece.is_flat();
    if (flat && std::abs((R_upright_map * piece.normal.cast<double>()).z()) > kLevelNormalZ) continue;
    const Eigen::Vector3d p = R_upright_map * piece.mean.cast<double>();
    Sum& sum = sums[column_of(p, cell)];
    const double weight = (flat ? 1.0 : kLooseShare) * area / cell;
    sum.p += weight * p.head<2>();
    sum.weight += weight;
  }
  std::vector<WallColumn> out;
  for (const auto& [at, sum] : sums) {
    if (sum.weight < kMinWallHeight) continue;
    out.push_back({(sum.p / sum.weight).cast<float>(),
                   std::min(static_cast<float>(sum.weight), kFullWallHeight) / kFullWallHeight});
  }
  return out;
}

std::vector<WallColumn> without_far(std::vector<WallColumn> walls) {
  for (int axis = 0; axis < 2 && !walls.empty(); ++axis) {
    std::vector<float> values;
    for (const WallColumn& wall : walls) values.push_back(wall.p[axis]);
    const auto [low, high] = near_range(std::move(values));
    std::erase_if(walls, [&](const WallColumn& wall) { return wall.p[axis] < low || wall.p[axis] > high; });
  }
  return walls;
}

/// @return whether the walls take no more cells than there may be.
bool WallGrid::frame(const std::vector<WallColumn>& walls, double cell) {
  Eigen::Vector2i low = Eigen::Vector2i::Constant(INT32_MAX);
  Eigen::Vector2i high = Eigen::Vector2i::Constant(INT32_MIN);
  for (const WallColumn& wall : walls) {
    low = low.cwiseMin(cell_at(wall.p, cell));
    high = high.cwiseMax(cell_at(wall.p, cell));
  }
  origin_ = low.array() - 2;
  size_ = high - low + Eigen::Vector2i::Constant(5);
  return static_cast<std::int64_t>(size_.x()) * size_.y() <= kMaxCells;
}

WallGrid::WallGrid(const AlignMap& map, const Eigen::Matrix3d& R_upright_map, double cell) {
  std::vector<WallColumn> walls = wall_columns(map, R_upright_map, cell);
  levels_.resize(kLevels);
  if (walls.empty()) return;
  if (!frame(walls, cell)) {
    walls = without_far(std::move(walls));
    if (!frame(walls, cell)) {
      size_ = Eigen::Vector2i::Zero();
      return;
    }
  }
  const auto at = [&](const Eigen::Vector2f& p) { return cell_at(p, cell); };
  std::vector<float> open(static_cast<std::size_t>(size_.x()) * size_.y(), 0.0F);
  std::vector<std::int8_t> image(open.size(), 0);
  const auto inside = [&](const Eigen::Vector2i& c) {
    return (c.array() >= 0).all() && (c.array() < size_.array()).all();
  };
  const auto index = [&](const Eigen::Vector2i& c) { return static_cast<std::size_t>(c.y()) * size_.x() + c.x(); };
  StopLook stop;
  for (const FreeColumn& column : map.free.columns()) {
    stop.step();
    const Eigen::Vector3d p = R_upright_map * column.p.cast<double>();
    const Eigen::Vector2i c = at(p.head<2>().cast<float>()) - origin_;
    if (inside(c)) open[index(c)] += column.height * std::min(1.0F, column.area / static_cast<float>(cell * cell));
  }
  for (std::size_t i = 0; i < image.size(); ++i) image[i] = open[i] > kMinOpenHeight ? kOpen : 0;
  for (const WallColumn& wall : walls) {
    stop.step();
    const Eigen::Vector2i c = at(wall.p) - origin_;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const float share = dx == 0 && dy == 0 ? 1.0F : dx == 0 || dy == 0 ? 0.7F : 0.5F;
        std::int8_t& value = image[index(c + Eigen::Vector2i(dx, dy))];
        value = std::max(value, static_cast<std::int8_t>(kWall * share * wall.height));
      }
    }
  }
  levels_[0] = std::move(image);
  make_levels();
}

void WallGrid::make_levels() {
  // Outside of the picture nobody looked, which is better than open: bounds count it as 0.
  for (int level = 1; level < kLevels; ++level) {
    const int reach = (1 << level) - 1;
    const int half = 1 << (level - 1);
    const int width = size_.x() + reach;
    const int height = size_.y() + reach;
    std::vector<std::int8_t>& out = levels_[level];
    out.resize(static_cast<std::size_t>(width) * height);
    for (int row = 0; row < height; ++row) {
      look_for_stop();
      for (int column = 0; column < width; ++column) {
        const int x = column - reach + origin_.x();
        const int y = row - reach + origin_.y();
        out[static_cast<std::size_t>(row) * width + column] =
            static_cast<std::int8_t>(std::max(std::max(at(level - 1, x, y), at(level - 1, x + half, y)),
                                              std::max(at(level - 1, x, y + half), at(level - 1, x + half, y + half))));
      }
    }
  }
}

}  // namespace concord
