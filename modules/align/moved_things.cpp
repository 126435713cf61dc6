#include "align/moved_things.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace concord {
namespace {

constexpr std::size_t kMostThings = 2;
constexpr double kRadius = 0.75;  // metres: a cupboard of one and a half metres
constexpr double kStep = 0.25;    // metres between the middles that are tried

/// The middle whose disc holds the most of what is against; the first in order where several do.
Eigen::Vector2d worst_disc(const std::vector<PieceAgainst>& pieces) {
  std::map<std::pair<int, int>, double> against;  // around each middle
  const int reach = static_cast<int>(std::ceil(kRadius / kStep));
  for (const PieceAgainst& piece : pieces) {
    const int x = static_cast<int>(std::floor(piece.p_target.x() / kStep));
    const int y = static_cast<int>(std::floor(piece.p_target.y() / kStep));
    for (int i = x - reach; i <= x + reach; ++i) {
      for (int j = y - reach; j <= y + reach; ++j) {
        if ((piece.p_target - kStep * Eigen::Vector2d(i, j)).norm() < kRadius) against[{i, j}] += piece.area;
      }
    }
  }
  const auto worst = std::max_element(against.begin(), against.end(),
                                      [](const auto& a, const auto& b) { return a.second < b.second; });
  return kStep * Eigen::Vector2d(worst->first.first, worst->first.second);
}

void take_out(const PieceAgainst& piece, Support& support) {
  Verdicts& verdicts = piece.is_of_source ? support.source_upright : support.target_upright;
  (piece.is_displaced ? verdicts.displaced : verdicts.contradicted) -= piece.area;
  support.against_facing -= piece.facing;
}

}  // namespace

MovedThings without_moved_things(const AlignMap& target, const AlignMap& source, const Transform& T_target_source,
                                 const Support& found, std::size_t pieces) {
  MovedThings out{{}, found};
  std::vector<PieceAgainst> against = pieces_against(target, source, T_target_source, pieces);
  while (!against.empty() && out.p_target.size() < kMostThings) {
    const Eigen::Vector2d middle = worst_disc(against);
    out.p_target.push_back(middle);
    std::erase_if(against, [&](const PieceAgainst& piece) {
      const bool is_in = (piece.p_target - middle).norm() < kRadius;
      if (is_in) take_out(piece, out.rest);
      return is_in;
    });
  }
  return out;
}

}  // namespace concord
