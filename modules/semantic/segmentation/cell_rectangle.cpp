#include "semantic/segmentation/cell_rectangle.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>

namespace concord {
namespace {

using Cell = std::pair<std::int32_t, std::int32_t>;

/// Strips that must agree before an outline has changed for good.
constexpr int kForGood = 3;
/// Strips that say how wide the piece is.
constexpr std::size_t kRemembered = 10;

/// Cells seen in a frame that is turned about the seed: which of its own cells are taken.
class Turned {
 public:
  Turned(const std::set<Cell>& cells, const std::set<Cell>& covered, Cell seed, double angle)
      : cells_(cells), covered_(covered), seed_(seed), cos_(std::cos(angle)), sin_(std::sin(angle)) {}

  [[nodiscard]] Cell to_lattice(int u, int v) const {
    const double x = cos_ * u - sin_ * v, y = sin_ * u + cos_ * v;
    return {seed_.first + static_cast<std::int32_t>(std::lround(x)),
            seed_.second + static_cast<std::int32_t>(std::lround(y))};
  }
  [[nodiscard]] std::pair<int, int> from_lattice(Cell cell) const {
    const double dx = cell.first - seed_.first, dy = cell.second - seed_.second;
    return {static_cast<int>(std::lround(cos_ * dx + sin_ * dy)),
            static_cast<int>(std::lround(-sin_ * dx + cos_ * dy))};
  }
  [[nodiscard]] bool at(int u, int v) const { return cells_.contains(to_lattice(u, v)); }
  [[nodiscard]] bool covered(int u, int v) const { return covered_.contains(to_lattice(u, v)); }

 private:
  const std::set<Cell>& cells_;
  const std::set<Cell>& covered_;
  Cell seed_;
  double cos_, sin_;
};

struct Run {
  int first = 0, last = 0;
  bool clear_first = true, clear_last = true;  ///< it ends there because the piece does
};

/// Looks along one axis of the turned frame: strips lie across it.
class Strips {
 public:
  Strips(const Turned& turned, bool swapped, int step, int gap)
      : turned_(turned), swapped_(swapped), step_(step), gap_(gap) {}

  /// How far along the axis the piece goes, both ways from the seed.
  [[nodiscard]] Run extent() const {
    const auto begin = run_at(0, 0);
    if (!begin) return {0, 0};
    return {-reach(-1, *begin), reach(1, *begin)};
  }

 private:
  [[nodiscard]] bool at(int along, int across) const {
    return swapped_ ? turned_.at(across, along) : turned_.at(along, across);
  }
  [[nodiscard]] bool covered(int along, int across) const {
    return swapped_ ? turned_.covered(across, along) : turned_.covered(along, across);
  }
  /// What hangs together in a strip around a place of it, or near that. Small gaps do not part it, nor does what stands
  /// on it.
  [[nodiscard]] std::optional<Run> run_at(int along, int around) const {
    std::optional<int> start;
    for (const int direction : {1, -1}) {
      const auto found = first_from(along, around, direction);
      if (found && (!start || std::abs(*found - around) < std::abs(*start - around))) start = found;
    }
    if (!start) return std::nullopt;
    const int first = end(along, *start, -1), last = end(along, *start, 1);
    return Run{first, last, !covered(along, first - 1) && !covered(along, first - 2),
               !covered(along, last + 1) && !covered(along, last + 2)};
  }
  [[nodiscard]] std::optional<int> first_from(int along, int around, int direction) const {
    for (int v = around, misses = 0; misses <= gap_; v += direction) {
      if (at(along, v)) return v;
      if (!covered(along, v)) ++misses;
    }
    return std::nullopt;
  }
  [[nodiscard]] int end(int along, int from, int direction) const {
    int last = from;
    for (auto next = std::optional(from); next; next = first_from(along, last + direction, direction)) last = *next;
    return last;
  }
  [[nodiscard]] int reach(int direction, Run begin) const {
    std::vector<int> lows, highs;
    remember(begin, lows, highs);
    int reached = 0, odd = 0, middle = (begin.first + begin.last) / 2;
    for (int along = direction;; along += direction) {
      const auto run = run_at(along, middle);
      if (!run) return reached;
      const bool wider = (!lows.empty() && run->first <= median(lows) - step_) ||
                         (!highs.empty() && run->last >= median(highs) + step_);
      odd = wider ? odd + 1 : 0;
      if (odd >= kForGood) return reached;
      if (wider) continue;
      reached = std::abs(along);
      remember(*run, lows, highs);
      middle = (run->first + run->last) / 2;
    }
  }
  static void remember(const Run& run, std::vector<int>& lows, std::vector<int>& highs) {
    if (run.clear_first) lows.push_back(run.first);
    if (run.clear_last) highs.push_back(run.last);
  }
  static int median(const std::vector<int>& all) {
    std::vector<int> last(all.end() - static_cast<std::ptrdiff_t>(std::min(all.size(), kRemembered)), all.end());
    std::ranges::nth_element(last, last.begin() + static_cast<std::ptrdiff_t>(last.size() / 2));
    return last[last.size() / 2];
  }

  const Turned& turned_;
  bool swapped_;
  int step_, gap_;
};

struct Piece {
  std::vector<Cell> cells;
  double filled = 0.0;
  int width = 0, length = 0;
};

/// Drops strips at both ends that are narrower than half of the middle one: what stands close to the piece, and is
/// level with it by chance.
Run without_tails(const std::map<int, int>& width) {
  std::vector<int> all;
  for (const auto& [along, cells] : width) all.push_back(cells);
  std::ranges::nth_element(all, all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2));
  const int half = (all[all.size() / 2] + 1) / 2;
  const auto wide = [&](const auto& strip) { return strip.second >= half; };
  const auto first = std::ranges::find_if(width, wide);
  const auto last = std::find_if(width.rbegin(), width.rend(), wide);
  return {first->first, last->first};
}

Piece piece_along(const std::set<Cell>& cells, const std::set<Cell>& covered, Cell seed, double angle, int step,
                  int gap) {
  const Turned turned(cells, covered, seed, angle);
  Run u = Strips(turned, false, step, gap).extent(), v = Strips(turned, true, step, gap).extent();
  std::map<int, int> across_u, across_v;
  const auto within = [&](Cell cell) {
    return cell.first >= u.first && cell.first <= u.last && cell.second >= v.first && cell.second <= v.last;
  };
  for (const Cell& cell : cells) {
    const auto at = turned.from_lattice(cell);
    if (within(at)) ++across_u[at.first], ++across_v[at.second];
  }
  Piece piece;
  if (across_u.empty()) return piece;
  u = without_tails(across_u);
  v = without_tails(across_v);
  int u0 = 1 << 20, u1 = -u0, v0 = u0, v1 = -u0;
  for (const Cell& cell : cells) {
    const auto at = turned.from_lattice(cell);
    if (!within(at)) continue;
    piece.cells.push_back(cell);
    u0 = std::min(u0, at.first), u1 = std::max(u1, at.first), v0 = std::min(v0, at.second),
    v1 = std::max(v1, at.second);
  }
  piece.width = std::min(u1 - u0, v1 - v0) + 1;
  piece.length = std::max(u1 - u0, v1 - v0) + 1;
  piece.filled = static_cast<double>(piece.cells.size()) / (static_cast<double>(piece.width) * piece.length);
  return piece;
}

/// Adds what lies between cells of a row and, as well, between cells of a column: what stands on the piece.
std::vector<Cell> with_holes_filled(const std::vector<Cell>& cells) {
  std::set<Cell> in(cells.begin(), cells.end()), across;
  const auto fill = [&](bool swapped, const auto& put) {
    std::vector<Cell> sorted;
    for (const auto& [x, y] : cells) sorted.push_back(swapped ? Cell{y, x} : Cell{x, y});
    std::ranges::sort(sorted);
    for (std::size_t i = 0; i + 1 < sorted.size(); ++i) {
      if (sorted[i].first != sorted[i + 1].first) continue;
      for (std::int32_t c = sorted[i].second + 1; c < sorted[i + 1].second; ++c)
        put(swapped ? Cell{c, sorted[i].first} : Cell{sorted[i].first, c});
    }
  };
  fill(false, [&](Cell cell) { across.insert(cell); });
  fill(true, [&](Cell cell) {
    if (across.contains(cell)) in.insert(cell);
  });
  return {in.begin(), in.end()};
}

}  // namespace

CellRectangle rectangle_around(const std::vector<Cell>& cells, const std::vector<Cell>& covered, Cell seed,
                               double resolution, double step, int directions) {
  const std::set<Cell> all(cells.begin(), cells.end()), under(covered.begin(), covered.end());
  const int cells_of_step = std::max(2, static_cast<int>(std::lround(step / resolution)));
  Piece best;
  for (int i = 0; i < directions; ++i) {
    Piece piece = piece_along(all, under, seed, i * std::numbers::pi / 2 / directions, cells_of_step, cells_of_step);
    const auto rank = [](const Piece& p) { return std::pow(p.filled, 4) * static_cast<double>(p.cells.size()); };
    if (rank(piece) > rank(best)) best = std::move(piece);
  }
  return {with_holes_filled(best.cells), best.width * resolution, best.length * resolution};
}

}  // namespace concord
