#include "align/column_search.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <set>
#include <tuple>

#include "align/sampling.hpp"
#include "align/wall_grid.hpp"
#include "align/workers.hpp"

namespace concord {
namespace {

constexpr std::size_t kMaxColumns = 500;  // of the source, spread evenly
constexpr std::size_t kMinColumns = 10;
struct Scale {
  double cell;         ///< metres
  std::size_t most;    ///< places
  double worst_share;  ///< of the best score: below it nothing is a rival
};
/// In a room walls say little and many places are cheap to look at; half of a room on half of it scores half of what a
/// wrong place may. In a building walls say nearly all.
constexpr Scale kRoom{0.1, 128, 0.2};
constexpr Scale kBuilding{0.2, 32, 0.4};
constexpr double kRoomReach = 6.0;  // metres from its middle: up to here it is a room
constexpr double kMaxYawStep = 2.0 * M_PI / 180.0;
constexpr std::size_t kBatch = 64;  // nodes opened together
constexpr std::size_t kMaxNodes = 400'000;
/// Bounds on what is taken before the first node is opened: windows in which to look, some seconds of one processor;
/// and turned columns, 128 MB.
constexpr std::size_t kMaxSeeds = 1 << 22;
constexpr std::size_t kMaxTurned = 1 << 24;
constexpr double kSamePlace = 5.0;  // cells
constexpr double kSameYaw = 10.0 * M_PI / 180.0;
constexpr int kTop = WallGrid::kLevels - 1;

struct Node {
  int bound;
  int level;
  int yaw;
  int x, y;
  /// The heap's order: best bound first, then the deepest; ties by place, so that they do not hang on anything else.
  bool operator<(const Node& o) const {
    if (bound != o.bound) return bound < o.bound;
    return std::tie(o.level, o.yaw, o.x, o.y) < std::tie(level, yaw, x, y);
  }
};

double wrapped(double angle) { return std::remainder(angle, 2.0 * M_PI); }

class Search {
 public:
  Search(const AlignMap& target, const Eigen::Matrix3d& R_target, const AlignMap& source,
         const Eigen::Matrix3d& R_source, const SearchWindow& window, int threads)
      : threads_(threads),
        window_(window),
        scale_(scale_for(source, R_source)),
        cell_(scale_.cell),
        grid_(target, R_target, cell_) {
    std::vector<WallColumn> walls = wall_columns(source, R_source, cell_);
    take_columns(walls);
    if (prepare()) return;
    // Few pieces that stand far off make a source wide: what it says of itself near by is enough to find it by.
    walls = without_far(wall_columns(source, R_source, kRoom.cell));
    scale_ = scale_for(walls);
    if (scale_.cell != cell_) {
      cell_ = scale_.cell;
      grid_ = WallGrid(target, R_target, cell_);
    }
    if (cell_ != kRoom.cell) walls = without_far(wall_columns(source, R_source, cell_));
    take_columns(walls);
    is_too_wide_ = !prepare();
  }

  std::vector<PlanarPose> run() {
    if (is_too_wide_ || columns_.size() < kMinColumns || grid_.size().minCoeff() == 0) return {};
    seed();
    return open_best_first();
  }

 private:
  struct Column {
    Eigen::Vector2d p;  // from the middle of the source
    int weight;
  };
  struct Turned {
    std::int32_t x, y;
  };

  static Scale scale_for(const AlignMap& source, const Eigen::Matrix3d& R) {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9);
    Eigen::Vector2d high = -low;
    for (const SurfaceCell& piece : source.levels.back().cells()) {
      const Eigen::Vector2d p = (R * piece.mean.cast<double>()).head<2>();
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    return (high - low).maxCoeff() < 2.0 * kRoomReach ? kRoom : kBuilding;
  }

  static Scale scale_for(const std::vector<WallColumn>& walls) {
    Eigen::Vector2f low = Eigen::Vector2f::Constant(1e9F);
    Eigen::Vector2f high = -low;
    for (const WallColumn& wall : walls) {
      low = low.cwiseMin(wall.p);
      high = high.cwiseMax(wall.p);
    }
    return (high - low).maxCoeff() < 2.0 * kRoomReach ? kRoom : kBuilding;
  }

  void take_columns(const std::vector<WallColumn>& walls) {
    middle_ = Eigen::Vector2d::Zero();
    columns_.clear();
    weight_ = 0;
    for (const WallColumn& wall : walls) middle_ += wall.p.cast<double>();
    if (!walls.empty()) middle_ /= static_cast<double>(walls.size());
    const std::size_t take = std::min(walls.size(), kMaxColumns);
    for (std::size_t i = 0; i < take; ++i) {
      const WallColumn& wall = walls[spread(i, take, walls.size())];
      columns_.push_back({wall.p.cast<double>() - middle_, 1 + static_cast<int>(3.0F * wall.height)});
      weight_ += columns_.back().weight;
    }
  }

  /// Turns the columns to all yaws. @return false: there is too much to look at.
  bool prepare() {
    if (columns_.size() < kMinColumns || grid_.size().minCoeff() == 0) return true;
    yaws_ = yaws();
    if (yaws_.size() * columns_.size() > kMaxTurned) return false;
    turned_.resize(yaws_.size() * columns_.size());
    for (std::size_t i = 0; i < yaws_.size(); ++i) {
      look_for_stop();
      const Eigen::Rotation2Dd R(yaws_[i]);
      for (std::size_t c = 0; c < columns_.size(); ++c) {
        const Eigen::Vector2d p = (R * columns_[c].p / cell_).array().floor();
        turned_[i * columns_.size() + c] = {static_cast<std::int32_t>(p.x()), static_cast<std::int32_t>(p.y())};
      }
    }
    return count_seeds() <= kMaxSeeds;
  }

  std::vector<double> yaws() const {
    std::vector<double> radii;
    for (const Column& column : columns_) radii.push_back(column.p.norm());
    std::nth_element(radii.begin(), radii.begin() + radii.size() * 9 / 10, radii.end());
    const double step = std::min(kMaxYawStep, cell_ / std::max(radii[radii.size() * 9 / 10], cell_));
    const auto& guess = window_.guess;
    const double middle = guess ? std::atan2(guess->linear()(1, 0), guess->linear()(0, 0)) : 0.0;
    const double reach = guess ? std::min(window_.yaw, M_PI) : M_PI;
    const int count = static_cast<int>(std::ceil(2.0 * reach / step));
    std::vector<double> out;
    for (int i = 0; i < count; ++i) out.push_back(wrapped(middle - reach + (i + 0.5) * 2.0 * reach / count));
    return out;
  }

  std::size_t count_seeds() const {
    std::size_t count = 0;
    for (std::size_t yaw = 0; yaw < yaws_.size() && count <= kMaxSeeds; ++yaw) {
      look_for_stop();
      for (const auto& [low, high] : windows(yaw)) {
        const auto side = [&](int axis) {
          return static_cast<std::size_t>((high[axis] >> kTop) - (low[axis] >> kTop) + 1);
        };
        count += side(0) * side(1);
      }
    }
    return count;
  }

  int bound(int yaw, int level, int x, int y) const {
    const Turned* turned = &turned_[yaw * columns_.size()];
    int sum = 0;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      sum += columns_[c].weight * grid_.at(level, turned[c].x + x, turned[c].y + y);
    }
    return sum;
  }

  /// Windows of shifts, [low, high] in cells, for one yaw.
  std::vector<std::pair<Eigen::Vector2i, Eigen::Vector2i>> windows(std::size_t yaw) const {
    const Turned* turned = &turned_[yaw * columns_.size()];
    if (!window_.guess) {
      Eigen::Vector2i low = Eigen::Vector2i::Constant(INT32_MAX / 2);
      Eigen::Vector2i high = -low;
      for (std::size_t c = 0; c < columns_.size(); ++c) {
        low = low.cwiseMin(Eigen::Vector2i(turned[c].x, turned[c].y));
        high = high.cwiseMax(Eigen::Vector2i(turned[c].x, turned[c].y));
      }
      return {{grid_.origin() - high, grid_.origin() + grid_.size() - low}};
    }
    // Points of the source that a wrong turn may have left in place: its origin, its middle, and what the guess puts on
    // the target's origin and middle.
    const Transform T_source_target = window_.guess->inverse();
    const Eigen::Vector2i middle = grid_.origin() + grid_.size() / 2;
    const Eigen::Vector3d p_target_middle(middle.x() * cell_, middle.y() * cell_, 0.0);
    const std::vector<Eigen::Vector2d> pivots{Eigen::Vector2d::Zero(), middle_,
                                              Eigen::Vector3d(T_source_target.translation()).head<2>(),
                                              Eigen::Vector3d(T_source_target * p_target_middle).head<2>()};
    std::vector<std::pair<Eigen::Vector2i, Eigen::Vector2i>> out;
    for (const Eigen::Vector2d& pivot : pivots) {
      const Eigen::Vector2d p_target = (*window_.guess * Eigen::Vector3d(pivot.x(), pivot.y(), 0.0)).head<2>();
      const Eigen::Vector2d shift = p_target - Eigen::Rotation2Dd(yaws_[yaw]) * (pivot - middle_);
      out.emplace_back(((shift.array() - window_.reach) / cell_).floor().cast<int>(),
                       ((shift.array() + window_.reach) / cell_).ceil().cast<int>());
    }
    return out;
  }

  void seed() {
    std::vector<std::vector<Node>> seeds(yaws_.size());
    for_each_chunk(threads_, seeds.size(), [&](std::size_t yaw) {
      std::set<std::pair<int, int>> corners;
      for (const auto& [low, high] : windows(yaw)) {
        for (int y = low.y() >> kTop; y <= high.y() >> kTop; ++y) {
          for (int x = low.x() >> kTop; x <= high.x() >> kTop; ++x) corners.emplace(y, x);
        }
      }
      StopLook stop;
      for (const auto& [y, x] : corners) {
        stop.step();
        const Node node{bound(static_cast<int>(yaw), kTop, x << kTop, y << kTop), kTop, static_cast<int>(yaw),
                        x << kTop, y << kTop};
        if (node.bound > 0) seeds[yaw].push_back(node);
      }
    });
    std::vector<Node> all;
    for (const std::vector<Node>& some : seeds) all.insert(all.end(), some.begin(), some.end());
    open_ = std::priority_queue<Node>(std::less<Node>(), std::move(all));
  }

  bool is_taken(const Node& node, const std::vector<Node>& taken) const {
    const int side = (1 << node.level) - 1;
    for (const Node& other : taken) {
      if (std::abs(wrapped(yaws_[node.yaw] - yaws_[other.yaw])) > kSameYaw) continue;
      const int x = std::max(std::abs(node.x - other.x), std::abs(node.x + side - other.x));
      const int y = std::max(std::abs(node.y - other.y), std::abs(node.y + side - other.y));
      if (std::hypot(x, y) < kSamePlace) return true;
    }
    return false;
  }

  std::vector<PlanarPose> open_best_first() {
    std::vector<Node> taken;
    std::size_t opened = 0;
    StopLook stop;
    while (!open_.empty() && taken.size() < scale_.most && opened < kMaxNodes) {
      std::vector<Node> batch;
      while (!open_.empty() && batch.size() < kBatch && taken.size() < scale_.most) {
        stop.step();
        const Node node = open_.top();
        // A place is taken in order: not while a better one may come out of this batch.
        if (node.level == 0 && !batch.empty()) break;
        open_.pop();
        if (!taken.empty() && node.bound < scale_.worst_share * taken.front().bound) {
          open_ = {};
          break;
        }
        if (is_taken(node, taken)) continue;
        (node.level == 0 ? taken : batch).push_back(node);
      }
      opened += batch.size();
      std::vector<std::array<Node, 4>> children(batch.size());
      const std::size_t per_chunk = 8;
      for_each_chunk(
          batch.size() > per_chunk ? threads_ : 1, chunks_of(batch.size(), per_chunk), [&](std::size_t chunk) {
            for (std::size_t i = chunk * per_chunk; i < std::min(batch.size(), (chunk + 1) * per_chunk); ++i) {
              const Node& node = batch[i];
              const int level = node.level - 1;
              for (int c = 0; c < 4; ++c) {
                const int x = node.x + ((c & 1) << level);
                const int y = node.y + ((c >> 1) << level);
                children[i][c] = {bound(node.yaw, level, x, y), level, node.yaw, x, y};
              }
            }
          });
      for (const auto& four : children) {
        for (const Node& child : four) {
          if (child.bound > 0) open_.push(child);
        }
      }
    }
    std::vector<PlanarPose> out;
    for (const Node& node : taken) {
      const double yaw = yaws_[node.yaw];
      const Eigen::Vector2d shift = Eigen::Vector2d(node.x, node.y) * cell_;
      out.push_back({yaw, shift - Eigen::Rotation2Dd(yaw) * middle_,
                     static_cast<double>(node.bound) / (static_cast<double>(WallGrid::kWall) * weight_)});
    }
    return out;
  }

  int threads_;
  SearchWindow window_;
  Scale scale_;
  double cell_;
  WallGrid grid_;
  bool is_too_wide_ = false;
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
  std::vector<Column> columns_;
  int weight_ = 0;
  std::vector<double> yaws_;
  std::vector<Turned> turned_;  // [yaw][column], cells
  std::priority_queue<Node> open_;
};

}  // namespace

std::vector<PlanarPose> search_columns(const AlignMap& target, const Eigen::Matrix3d& R_upright_target,
                                       const AlignMap& source, const Eigen::Matrix3d& R_upright_source,
                                       const SearchWindow& window, int threads) {
  return Search(target, R_upright_target, source, R_upright_source, window, threads).run();
}

}  // namespace concord
