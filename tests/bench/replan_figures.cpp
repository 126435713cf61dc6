#include "replan_figures.hpp"

#include <algorithm>
#include <ctime>
#include <random>

#include "planner/scenario/path_check.hpp"
#include "planner/search/kept_path.hpp"

namespace concord {
namespace {

constexpr std::size_t kQueries = 40;
constexpr int kEdits = 10;

template <class Work>
double time_us(Work work) {
  timespec begin{}, end{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &begin);
  work();
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &end);
  return static_cast<double>(end.tv_sec - begin.tv_sec) * 1e6 + static_cast<double>(end.tv_nsec - begin.tv_nsec) * 1e-3;
}

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
  // Each has a grid of its own, so that neither finds in the cache what the other has just used.
  GridPaths followed(grid), other(grid);
  other.prepare_clear();
  const std::size_t stride = std::max<std::size_t>(1, queries.size() / kQueries);
  for (std::size_t i = stride / 2; i < queries.size(); i += stride) {
    const ScenarioQuery& query = queries[i];
    KeptPath kept(followed);
    (void)kept.plan(query.start, query.goal);
    for (int e = 0; e < kEdits && kept.path(); ++e) {
      const Edit edit = random_edit(random, grid, kept.path()->cells);
      if (edit.holds(query.start) || edit.holds(query.goal)) continue;
      KeptPath::Outcome outcome{};
      figures.follow_us.push_back(time_us([&] {
        const bool opened = followed.update(edit.window, edit);
        outcome = kept.follow(edit.window, opened);
      }));
      std::optional<ClearPath> scratch;
      figures.scratch_us.push_back(time_us([&] {
        other.update(edit.window, edit);
        scratch = other.clear(query.start, query.goal);
      }));
      count(figures, outcome);
      figures.improve_us.push_back(time_us([&] { figures.improved += kept.improve() ? 1 : 0; }));
      const bool is_right = kept.path().has_value() == scratch.has_value() &&
                            (!scratch || stays_in_open_cells(followed.grid(), kept.path()->turns));
      if (!is_right) ++figures.wrong;
      if (!is_right || !scratch || scratch->cost == 0) continue;
      figures.worst_cost =
          std::max(figures.worst_cost, static_cast<double>(kept.path()->cost) / static_cast<double>(scratch->cost));
    }
  }
  return figures;
}

}  // namespace concord
