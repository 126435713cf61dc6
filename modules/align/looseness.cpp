#include "align/looseness.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "align/evidence.hpp"
#include "align/gates.hpp"
#include "align/hypotheses.hpp"

namespace concord {
namespace {

constexpr std::size_t kPieces = 6000;
/// Metres; the least is what would do harm.
constexpr std::array<double, 8> kSlides{-0.3, 0.3, -0.6, 0.6, -1.0, 1.0, -2.0, 2.0};
/// Degrees; the least moves what stands at a metre by more than what still counts as lying right.
constexpr std::array<double, 4> kTurns{-8.0, 8.0, -15.0, 15.0};

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

std::vector<std::string> loose_directions(const AlignMap& target, const AlignMap& source,
                                          const Transform& T_target_source, int threads) {
  const auto at = [&](const Transform& T) { return support(target, source, T, kPieces, threads); };
  const Support good = at(T_target_source);
  const auto slides = [&](const Eigen::Vector3d& axis, auto&& is_loose) {
    return std::any_of(kSlides.begin(), kSlides.end(),
                       [&](double step) { return is_loose(at(slid(T_target_source, step * axis)), good); });
  };
  const Eigen::Vector2d weak = good.weak_direction();
  std::vector<std::string> out;
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(weak.x(), weak.y(), 0.0), Eigen::Vector3d(-weak.y(), weak.x(), 0.0)}) {
    if (slides(axis, is_as_good)) out.push_back(slide_along(axis));
  }
  if (slides(Eigen::Vector3d::UnitZ(), is_as_good_in_height)) out.push_back(slide_along(Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d pivot = T_target_source * middle_of(source);
  const auto turns = [&](double degrees) { return is_as_good(at(turned(T_target_source, degrees, pivot)), good); };
  if (std::any_of(kTurns.begin(), kTurns.end(), turns)) out.emplace_back("turns about z (0.00 0.00 1.00)");
  return out;
}

}  // namespace concord
