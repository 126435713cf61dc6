#include "planner/lattice/sight.hpp"

#include <algorithm>

namespace concord {

bool sees(const OpenGrid& grid, Cell from, Cell to) {
  if (!grid.is_open(from) || !grid.is_open(to)) return false;
  const LineOfCells line(from, to);
  const BitLines& lines = line.along_x ? grid.rows() : grid.columns();
  const int begin = (line.along_x ? from.x : from.y) + 1;
  const int beside = (line.along_x ? from.y : from.x) + 1;
  const int along = line.along_x ? line.sign_x : line.sign_y;
  const int across = line.along_x ? line.sign_y : line.sign_x;
  return line.for_each_span([&](int i, int first, int last) {
    const int a = begin + along * first;
    const int b = begin + along * last;
    return lines.all(beside + across * i, std::min(a, b), std::max(a, b));
  });
}

}  // namespace concord
