#include "replan_figures.hpp"

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "planner/scenario/path_check.hpp"
#include "planner/search/kept_path.hpp"

namespace concord {
namespace {

constexpr std::size_t kQueries = 40;
constexpr int kEdits = 10;
constexpr int kRounds = 3;

struct Edit {
  Window window;
  bool open;

  void operator()(OpenGrid& grid) const {
    for (int y = window.low.y; y <= window.high.y; ++y) {
      for (int x = window.low.x; x <= window.high.x; ++x) grid.set({x, y}, open);
    }
  }
  [[nodiscard]] bool holds(Cell c) const {
    return c.x >= window.low.x && c.x <= window.high.x && c.y >= window.low.y && c.y <= window.high.y;
  }
};

Edit random_edit(std::mt19937& random, const OpenGrid& grid, const std::vector<Cell>& path) {
  const auto below = [&](std::size_t n) { return static_cast<int>(random() % n); };
  Cell centre{below(static_cast<std::size_t>(grid.width())), below(static_cast<std::size_t>(grid.height()))};
  if (below(5) < 3) centre = path[static_cast<std::size_t>(below(path.size()))];
  const int x = 1 + below(4);
  const int y = 1 + below(4);
  return {{{std::max(centre.x - x, 0), std::max(centre.y - y, 0)},
           {std::min(centre.x + x, grid.width() - 1), std::min(centre.y + y, grid.height() - 1)}},
          below(3) == 0};
}

struct Times {
  double follow = std::numeric_limits<double>::max(), scratch = follow, improve = follow;
};

Times least_of(const Times& a, const Times& b) {
  return {std::min(a.follow, b.follow), std::min(a.scratch, b.scratch), std::min(a.improve, b.improve)};
}

/// As in a process that does other things between two changes: neither side finds in the cache what it used last.
/// Without this the search from scratch did, which runs after every edit, and following did not, which seldom searches.
void forget() {
  static std::vector<std::uint8_t> other_things(std::size_t{8} << 20);
  for (std::size_t i = 0; i < other_things.size(); i += 64) ++other_things[i];
}

template <class Work>
double time_us(Work work) {
  forget();
  timespec begin{}, end{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &begin);
  work();
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &end);
  return static_cast<double>(end.tv_sec - begin.tv_sec) * 1e6 + static_cast<double>(end.tv_nsec - begin.tv_nsec) * 1e-3;
}

/// One of several that do the same: what else the machine does shows in a single time. Following and searching have a
/// grid each, so that neither finds in the cache what the other has just used.
struct Round {
  std::unique_ptr<GridPaths> followed, other;
  std::unique_ptr<KeptPath> kept;
  KeptPath::Outcome outcome{};
  std::optional<ClearPath> found;
  bool improved = false;

  explicit Round(const OpenGrid& grid)
      : followed(std::make_unique<GridPaths>(grid)), other(std::make_unique<GridPaths>(grid)) {
    other->prepare_clear();
  }
  void begin(const ScenarioQuery& query) {
    kept = std::make_unique<KeptPath>(*followed);
    (void)kept->plan(query.start, query.goal);
  }
  Times take(const Edit& edit, const ScenarioQuery& query, bool follow_first) {
    Times times;
    const auto follow = [&] {
      times.follow = time_us([&] {
        const bool opened = followed->update(edit.window, edit);
        outcome = kept->follow(edit.window, opened);
      });
    };
    if (follow_first) follow();
    times.scratch = time_us([&] {
      other->update(edit.window, edit);
      found = other->clear(query.start, query.goal);
    });
    if (!follow_first) follow();
    times.improve = time_us([&] { improved = kept->improve(); });
    return times;
  }
};

void count(ReplanFigures& figures, KeptPath::Outcome outcome) {
  switch (outcome) {
    case KeptPath::Outcome::kKept: ++figures.kept; break;
    case KeptPath::Outcome::kRepaired: ++figures.repaired; break;
    case KeptPath::Outcome::kAnew: ++figures.anew; break;
    case KeptPath::Outcome::kUnreachable: ++figures.unreachable; break;
  }
}

}  // namespace

ReplanFigures replan_figures(const OpenGrid& grid, const std::vector<ScenarioQuery>& queries) {
  ReplanFigures figures;
  std::mt19937 random(1);
  std::vector<Round> rounds;
  for (int r = 0; r < kRounds; ++r) rounds.emplace_back(grid);
  const std::size_t stride = std::max<std::size_t>(1, queries.size() / kQueries);
  for (std::size_t i = stride / 2; i < queries.size(); i += stride) {
    const ScenarioQuery& query = queries[i];
    for (Round& round : rounds) round.begin(query);
    KeptPath& kept = *rounds[0].kept;
    for (int e = 0; e < kEdits && kept.path(); ++e) {
      const Edit edit = random_edit(random, grid, kept.path()->cells);
      if (edit.holds(query.start) || edit.holds(query.goal)) continue;
      Times least;
      for (int r = 0; r < kRounds; ++r) least = least_of(least, rounds[r].take(edit, query, r % 2 == 0));
      figures.follow_us.push_back(least.follow);
      figures.scratch_us.push_back(least.scratch);
      figures.improve_us.push_back(least.improve);
      figures.improved += rounds[0].improved ? 1 : 0;
      count(figures, rounds[0].outcome);
      const std::optional<ClearPath>& scratch = rounds[0].found;
      const bool is_right = kept.path().has_value() == scratch.has_value() &&
                            (!scratch || stays_in_open_cells(rounds[0].followed->grid(), kept.path()->turns));
      if (!is_right) ++figures.wrong;
      if (!is_right || !scratch || scratch->cost == 0) continue;
      figures.worst_cost =
          std::max(figures.worst_cost, static_cast<double>(kept.path()->cost) / static_cast<double>(scratch->cost));
    }
  }
  return figures;
}

}  // namespace concord
