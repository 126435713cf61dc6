#include "align/moved_things.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "align/workers.hpp"

namespace concord {
namespace {

constexpr double kStep = 0.25;  // metres between the middles that are tried

bool is_in(const PieceAgainst& piece, const Eigen::Vector2d& middle, double radius) {
  return (piece.p_target.head<2>() - middle).norm() < radius;
}

/// The middle whose disc holds the most of what is against; the first in order where several do.
Eigen::Vector2d worst_disc(const std::vector<PieceAgainst>& pieces, double radius) {
  std::map<std::pair<int, int>, double> against;  // around each middle
  const int reach = static_cast<int>(std::ceil(radius / kStep));
  for (const PieceAgainst& piece : pieces) {
    look_for_stop();
    const int x = static_cast<int>(std::floor(piece.p_target.x() / kStep));
    const int y = static_cast<int>(std::floor(piece.p_target.y() / kStep));
    for (int i = x - reach; i <= x + reach; ++i) {
      for (int j = y - reach; j <= y + reach; ++j) {
        if (is_in(piece, kStep * Eigen::Vector2d(i, j), radius)) against[{i, j}] += piece.area;
      }
    }
  }
  const auto worst = std::max_element(against.begin(), against.end(),
                                      [](const auto& a, const auto& b) { return a.second < b.second; });
  return kStep * Eigen::Vector2d(worst->first.first, worst->first.second);
}

double height_of(const std::vector<PieceAgainst>& pieces, const Eigen::Vector2d& middle, double radius) {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  for (const PieceAgainst& piece : pieces) {
    if (!is_in(piece, middle, radius)) continue;
    low = std::min(low, piece.p_target.z());
    high = std::max(high, piece.p_target.z());
  }
  return high - low;
}

void take_out(const PieceAgainst& piece, Support& support) {
  Verdicts& verdicts = piece.is_of_source ? support.source_upright : support.target_upright;
  (piece.is_displaced ? verdicts.displaced : verdicts.contradicted) -= piece.area;
  support.against_facing -= piece.facing;
}

}  // namespace

MovedThings without_moved_things(const AlignMap& target, const AlignMap& source, const Transform& T_target_source,
                                 const Support& found, std::size_t pieces, const Movable& movable, std::size_t most) {
  MovedThings out{{}, found};
  std::vector<PieceAgainst> against = pieces_against(target, source, T_target_source, pieces);
  while (!against.empty() && out.p_target.size() < most) {
    const Eigen::Vector2d middle = worst_disc(against, movable.radius);
    if (height_of(against, middle, movable.radius) > movable.height) break;
    out.p_target.push_back(middle);
    std::erase_if(against, [&](const PieceAgainst& piece) {
      const bool is_of_it = is_in(piece, middle, movable.radius);
      if (is_of_it) take_out(piece, out.rest);
      return is_of_it;
    });
  }
  return out;
}

}  // namespace concord
