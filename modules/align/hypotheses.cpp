#include "align/hypotheses.hpp"

#include <algorithm>
#include <cmath>

#include "align/column_search.hpp"
#include "align/gates.hpp"
#include "align/height_search.hpp"
#include "align/sampling.hpp"
#include "align/workers.hpp"

namespace concord {
namespace {

// What a person's guess may be off by, with a margin: 2 m on each axis, 45 degrees of yaw.
constexpr double kGuessYaw = 46.0 * M_PI / 180.0;
constexpr double kYawSlack = 1.0 * M_PI / 180.0;  // what refinement may add
constexpr double kGuessReach = 2.6;               // metres
constexpr double kReachSlack = 0.4;               // metres: by which people's middle of a map and ours differ, turned
constexpr double kGuessHeight = 2.3;              // metres: less than a storey of a house
/// A guess that is tilted by more than this means it: the source's frame is not upright. Less is a shaky hand.
constexpr double kMeantTilt = 15.0 * M_PI / 180.0;
constexpr double kAnyHeight = 50.0;

constexpr std::size_t kQuickPoints = 800;
constexpr int kQuickIterations = 8;
constexpr std::size_t kQuickPieces = 1000;
constexpr std::size_t kBestPlaces = 8;  // that are refined and judged with care
constexpr std::size_t kRoughPoints = 3000;
constexpr std::size_t kFinePoints = 2500;
constexpr std::size_t kLastPoints = 4000;
constexpr std::size_t kMinLevelCells = 150;  // flat ones; a coarser level of a small room says nothing
constexpr int kRoughIterations = 12;
constexpr int kFineIterations = 40;
constexpr int kLastIterations = 60;
constexpr double kRoughStep = 0.005;   // cells, where a finer level follows
constexpr double kMaxThickness = 0.2;  // cells
constexpr double kMinKernel = 0.05;    // metres
constexpr double kNoiseKernel = 3.0;   // standard deviations
constexpr double kLastStep = 3e-4;     // metres
constexpr std::size_t kJudgePieces = 4000;
constexpr double kApart = 0.25;  // metres
constexpr double kTurnApart = 3.0 * M_PI / 180.0;

std::size_t flat_count(const SurfaceLevel& level) {
  return std::count_if(level.cells().begin(), level.cells().end(), [](const SurfaceCell& c) { return c.is_flat(); });
}

/// Those cells of the source that come near the target under `T`, spread evenly, `most` at most.
std::vector<SurfaceCell> cropped(const AlignMap& target, const SurfaceLevel& source, const Transform& T,
                                 std::size_t most) {
  std::vector<SurfaceCell> near;
  StopLook stop;
  for (const SurfaceCell& cell : source.cells()) {
    stop.step();
    if (target.levels.back().nearest(T * cell.mean.cast<double>()) != nullptr) near.push_back(cell);
  }
  if (near.size() <= most) return near;
  std::vector<SurfaceCell> out;
  for (std::size_t i = 0; i < most; ++i) out.push_back(near[spread(i, most, near.size())]);
  return out;
}

/// One level: the source's cells of about the size of the target's against those.
void refine_level(const AlignMap& target, const SurfaceLevel& to, const SurfaceLevel& from, std::size_t points,
                  int iterations, int threads, GicpResult& result) {
  const std::vector<SurfaceCell> source = cropped(target, from, result.T_target_source, points);
  const int before = result.iterations;
  result = refine(to, source, result.T_target_source,
                  {.kernel = 0.5 * to.size(),
                   .max_iterations = iterations,
                   .min_step = kRoughStep * to.size(),
                   .threads = threads});
  result.iterations += before;
}

/// The levels that both have, coarse to fine, down to the one next to the finest.
GicpResult refine_roughly(const AlignMap& target, const AlignMap& source, const Transform& T, std::size_t points,
                          int iterations, int threads) {
  GicpResult result;
  result.T_target_source = T;
  const std::size_t levels = std::min(target.levels.size(), source.levels.size());
  for (std::size_t i = 1; i <= std::min<std::size_t>(levels, 2); ++i) {
    const SurfaceLevel& to = target.levels[target.levels.size() - i];
    const SurfaceLevel& from = source.levels[source.levels.size() - i];
    if (i < levels && i < 2 && std::min(flat_count(to), flat_count(from)) < kMinLevelCells) continue;
    refine_level(target, to, from, points, iterations, threads, result);
  }
  return result;
}

/// The level next to the coarsest alone.
Hypothesis look_quickly(const AlignMap& target, const AlignMap& source, const Transform& T, int threads) {
  GicpResult result;
  result.T_target_source = T;
  const auto middle = [](const AlignMap& map) -> const SurfaceLevel& {
    return map.levels[map.levels.size() >= 2 ? map.levels.size() - 2 : 0];
  };
  refine_level(target, middle(target), middle(source), kQuickPoints, kQuickIterations, threads, result);
  return {result.T_target_source, support(target, source, result.T_target_source, kQuickPieces, threads),
          result.iterations};
}

/// Best first; of those at one place the best.
void sort_places(std::vector<Hypothesis>& places, const Eigen::Vector3d& p_source_middle) {
  std::stable_sort(places.begin(), places.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return ranks_before(a.support, b.support); });
  std::vector<Hypothesis> apart;
  for (const Hypothesis& place : places) {
    const auto is_same = [&](const Hypothesis& other) {
      return !are_apart(place.T_target_source, other.T_target_source, p_source_middle);
    };
    if (std::none_of(apart.begin(), apart.end(), is_same)) apart.push_back(place);
  }
  places = std::move(apart);
}

struct UprightPair {
  Eigen::Matrix3d target, source;
  std::optional<Transform> guess;  ///< between the upright frames
};

UprightPair make_upright(const AlignMap& target, const AlignMap& source, const std::optional<Transform>& guess) {
  UprightPair out{target.R_upright_map, source.R_upright_map, std::nullopt};
  if (!guess) return out;
  const auto between = [&] { return Transform(Transform(out.target) * *guess * Transform(out.source).inverse()); };
  Transform T = between();
  if (std::acos(std::clamp(T.linear()(2, 2), -1.0, 1.0)) > kMeantTilt) {
    const double yaw = std::atan2(guess->linear()(1, 0), guess->linear()(0, 0));
    out.source = Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()) * out.target * guess->linear();
    T = between();
  }
  out.guess = T;
  return out;
}

/// How far to lift the source: anywhere, or near where a guess has its middle or its origin.
std::pair<double, double> height_window(const UprightPair& pair, const AlignMap& source) {
  if (!pair.guess) return {-kAnyHeight, kAnyHeight};
  const Eigen::Vector3d middle = pair.source * middle_of(source);
  const double at_origin = pair.guess->translation().z();
  const double at_middle = (*pair.guess * middle).z() - middle.z();
  return {std::min(at_origin, at_middle) - kGuessHeight, std::max(at_origin, at_middle) + kGuessHeight};
}

std::vector<Transform> places(const AlignMap& target, const AlignMap& source, const std::optional<Vicinity>& vicinity,
                              int threads) {
  std::optional<Transform> guess;
  if (vicinity) guess = vicinity->T_target_source;
  const UprightPair pair = make_upright(target, source, guess);
  const auto [low, high] = height_window(pair, source);
  const SearchWindow window{pair.guess, vicinity ? vicinity->yaw : 0.0, vicinity ? vicinity->reach : 0.0};
  std::vector<Transform> out;
  for (const PlanarPose& pose : search_columns(target, pair.target, source, pair.source, window, threads)) {
    Transform T = Transform::Identity();
    T.translation().head<2>() = pose.t;
    T.rotate(Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ()));
    for (const double z : search_heights(target, pair.target, source, pair.source, T, low, high)) {
      Transform lifted = T;
      lifted.translation().z() = z;
      out.emplace_back(Transform(pair.target).inverse() * lifted * Transform(pair.source));
    }
  }
  if (guess) out.push_back(*guess);
  return out;
}

}  // namespace

Eigen::Vector3d middle_of(const AlignMap& map) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const std::vector<SurfaceCell>& cells = map.levels.back().cells();
  for (const SurfaceCell& cell : cells) sum += cell.mean.cast<double>();
  return cells.empty() ? sum : Eigen::Vector3d(sum / static_cast<double>(cells.size()));
}

bool are_apart(const Transform& a, const Transform& b, const Eigen::Vector3d& p_source_middle) {
  return (a * p_source_middle - b * p_source_middle).norm() > kApart ||
         Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle() > kTurnApart;
}

Vicinity around_guess(const Transform& guess) { return {guess, kGuessYaw, kGuessReach}; }

bool is_in(const Vicinity& vicinity, const Transform& T_target_source, const Eigen::Vector3d& p_source_middle) {
  const Transform& middle = vicinity.T_target_source;
  const Eigen::Matrix3d R = T_target_source.linear() * middle.linear().transpose();
  if (std::abs(std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1))) > vicinity.yaw + kYawSlack) return false;
  const auto is_in_reach = [&](const Eigen::Vector3d& p_source) {
    const Eigen::Vector3d d = T_target_source * p_source - middle * p_source;
    return d.head<2>().cwiseAbs().maxCoeff() <= vicinity.reach + kReachSlack && std::abs(d.z()) <= kGuessHeight;
  };
  return is_in_reach(Eigen::Vector3d::Zero()) || is_in_reach(p_source_middle);
}

std::vector<Hypothesis> find_hypotheses(const AlignMap& target, const AlignMap& source,
                                        const std::optional<Vicinity>& vicinity, int threads) {
  const Eigen::Vector3d middle = middle_of(source);
  std::vector<Hypothesis> all;
  for (const Transform& place : places(target, source, vicinity, threads)) {
    all.push_back(look_quickly(target, source, place, threads));
  }
  sort_places(all, middle);
  if (all.size() > kBestPlaces) all.resize(kBestPlaces);
  for (Hypothesis& h : all) {
    const GicpResult result =
        refine_roughly(target, source, h.T_target_source, kRoughPoints, kRoughIterations, threads);
    h.T_target_source = result.T_target_source;
    h.iterations += result.iterations;
    h.support = support(target, source, h.T_target_source, kJudgePieces, threads);
  }
  if (vicinity) std::erase_if(all, [&](const Hypothesis& h) { return !is_in(*vicinity, h.T_target_source, middle); });
  sort_places(all, middle);
  return all;
}

GicpResult refine_fully(const AlignMap& target, const AlignMap& source, const Transform& T, int threads) {
  const GicpResult rough = refine_roughly(target, source, T, kFinePoints, kRoughIterations, threads);
  GicpResult result = refine_finely(target, source, rough.T_target_source, threads);
  result.iterations += rough.iterations;
  return result;
}

namespace {

/// The finest level in whose cells surfaces are thin: where noise fills cells, the nearest one is near wherever the
/// source lies, and says nothing.
std::size_t finest_clean(const AlignMap& target, const AlignMap& source) {
  const std::size_t levels = std::min(target.levels.size(), source.levels.size());
  for (std::size_t i = 0; i + 1 < levels; ++i) {
    const auto is_clean = [i](const AlignMap& map) {
      return map.levels[i].thickness() < kMaxThickness * map.levels[i].size();
    };
    if (is_clean(target) && is_clean(source)) return i;
  }
  return levels >= 2 ? levels - 2 : 0;
}

}  // namespace

GicpResult refine_finely(const AlignMap& target, const AlignMap& source, const Transform& T, int threads) {
  GicpResult result;
  result.T_target_source = T;
  const std::size_t finest = finest_clean(target, source);
  const SurfaceLevel& to = target.levels[finest];
  const SurfaceLevel& from = source.levels[finest];
  refine_level(target, to, from, kFinePoints, kFineIterations, threads, result);
  std::vector<SurfaceCell> points;
  const std::size_t take = std::min(source.points.size(), kLastPoints);
  StopLook stop;
  for (std::size_t i = 0; i < take; ++i) {
    stop.step();
    const Eigen::Vector3f& p = source.points[spread(i, take, source.points.size())];
    const SurfaceCell* cell = from.nearest(p.cast<double>());
    if (cell == nullptr || (!cell->is_flat() && !cell->is_solid)) continue;
    if (target.levels.back().nearest(result.T_target_source * p.cast<double>()) == nullptr) continue;
    points.push_back({p, cell->normal, cell->one_sided, cell->is_solid});
  }
  const int before = result.iterations;
  const double kernel = std::max({target.resolution, kMinKernel, kNoiseKernel * to.thickness()});
  result = refine(to, points, result.T_target_source,
                  {.kernel = kernel, .max_iterations = kLastIterations, .min_step = kLastStep, .threads = threads});
  result.iterations += before;
  return result;
}

}  // namespace concord
