#include <array>
#include <vector>

#include "must.hpp"
#include "planner/scenario/path_check.hpp"
#include "planner/scenario/textbook.hpp"
#include "planner/search/grid_paths.hpp"

using namespace concord;

/// Any bytes as a small grid, edits and questions: every search finds a way where there is one, over open cells, and
/// the fast one the shortest.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::size_t at = 0;
  const auto byte = [&] { return at < size ? data[at++] : std::uint8_t{0}; };
  const int width = 1 + byte() % 80;
  const int height = 1 + byte() % 24;
  OpenGrid first(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; x += 8) {
      const std::uint8_t cells = byte();
      for (int i = 0; i < 8 && x + i < width; ++i) first.set({x + i, y}, (cells >> i & 1) == 0);
    }
  }
  GridPaths paths(first);
  const auto cell = [&] { return Cell{byte() % width, byte() % height}; };
  for (int round = 0; round < 8 && at < size; ++round) {
    const Cell start = cell();
    const Cell goal = cell();
    const auto shortest = TextbookAStar(paths.grid()).find(start, goal);
    fuzz::must(paths.connected(start, goal) == shortest.has_value());
    const auto fast = paths.fast(start, goal);
    const auto taut = paths.any_angle(start, goal);
    const auto clear = paths.clear(start, goal);
    fuzz::must(fast.has_value() == shortest.has_value() && taut.has_value() == fast.has_value() &&
               clear.has_value() == fast.has_value());
    if (fast) {
      fuzz::must(fast->cost == *shortest);
      for (const auto& turns : {fast->turns, taut->turns, clear->turns}) {
        fuzz::must(turns.front() == start && turns.back() == goal && stays_in_open_cells(paths.grid(), turns));
      }
    }
    Window window{cell(), {}};
    window.high = {std::min(window.low.x + byte() % 8, width - 1), std::min(window.low.y + byte() % 8, height - 1)};
    paths.update(window, [&](OpenGrid& grid) {
      for (int y = window.low.y; y <= window.high.y; ++y)
        for (int x = window.low.x; x <= window.high.x; ++x) grid.set({x, y}, byte() % 3 != 0);
    });
  }
  return 0;
}
