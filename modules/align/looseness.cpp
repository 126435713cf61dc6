#include "align/looseness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>

#include "align/evidence.hpp"
#include "align/gates.hpp"
#include "align/hypotheses.hpp"
#include "align/moved_things.hpp"

namespace concord {
namespace {

constexpr std::size_t kPieces = 6000;
/// Metres; the least is what would do harm.
constexpr std::array<double, 8> kSlides{-0.3, 0.3, -0.6, 0.6, -1.0, 1.0, -2.0, 2.0};
/// Degrees; the least moves what stands at a metre by more than what still counts as lying right.
constexpr std::array<double, 4> kTurns{-8.0, 8.0, -15.0, 15.0};

/// What may have moved between two sessions holds nothing: a cupboard in a corridor would take the source along. It
/// speaks against a place beside the right one twice: where it stands in the one and in the other.
/// Asked of the far slides: near ones hardly contradict anything but what stands free.
constexpr Movable kCupboard{1.0, 2.3};
constexpr std::array<double, 4> kFar{-1.0, 1.0, -2.0, 2.0};

std::string slide_along(const Eigen::Vector3d& axis) {
  int largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  const Eigen::Vector3d a = axis[largest] < 0.0 ? Eigen::Vector3d(-axis) : axis;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "slides along %c (%.2f %.2f %.2f)", "xyz"[largest], a.x(), a.y(), a.z());
  return text.data();
}

Transform slid(Transform T, const Eigen::Vector3d& by) {
  T.translation() += by;
  return T;
}

Transform turned(const Transform& T, double degrees, const Eigen::Vector3d& p_target_pivot) {
  Transform turn = Transform::Identity();
  turn.translate(p_target_pivot);
  turn.rotate(Eigen::AngleAxisd(degrees * M_PI / 180.0, Eigen::Vector3d::UnitZ()));
  turn.translate(Eigen::Vector3d(-p_target_pivot));
  return turn * T;
}

}  // namespace

std::vector<Loose> loose_directions(const AlignMap& target, const AlignMap& source, const Transform& T_target_source,
                                    int threads) {
  const auto at = [&](const Transform& T) { return support(target, source, T, kPieces, threads); };
  const Support good = at(T_target_source);
  const auto is_as_good_at = [&](const Transform& T) { return is_as_good(at(T), good); };
  const auto is_as_good_at_height = [&](const Transform& T) { return is_as_good_in_height(at(T), good); };
  const auto is_held_by_a_cupboard = [&](const Transform& T) {
    const Support moved = at(T);
    return is_held_by_a_thing(without_moved_things(target, source, T, moved, kPieces, kCupboard, 2).rest, good);
  };
  const auto farthest = [&](std::span<const double> steps, const Eigen::Vector3d& axis, auto&& is_loose) {
    double by = 0.0;
    for (const double step : steps) {
      if (std::abs(step) > by && is_loose(slid(T_target_source, step * axis))) by = std::abs(step);
    }
    return by;
  };
  std::vector<Loose> out;
  const auto add_slide = [&](const Eigen::Vector3d& axis, double by) {
    if (by > 0.0) out.push_back({slide_along(axis), axis, by, false});
  };
  const Eigen::Vector2d weak = good.weak_direction();
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(weak.x(), weak.y(), 0.0), Eigen::Vector3d(-weak.y(), weak.x(), 0.0)}) {
    add_slide(axis, std::max(farthest(kSlides, axis, is_as_good_at), farthest(kFar, axis, is_held_by_a_cupboard)));
  }
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  add_slide(up, farthest(kSlides, up, is_as_good_at_height));
  const Eigen::Vector3d pivot = T_target_source * middle_of(source);
  for (const double degrees : kTurns) {
    if (!is_as_good_at(turned(T_target_source, degrees, pivot))) continue;
    out.push_back({"turns about z (0.00 0.00 1.00)", up, std::abs(degrees) * M_PI / 180.0, true});
    break;
  }
  return out;
}

}  // namespace concord
