#include <string_view>

#include "must.hpp"
#include "planner/files/map_server.hpp"
#include "planner/files/movingai.hpp"

using namespace concord;

namespace {

void read_scenario(std::string_view text) {
  const auto queries = read_movingai_scenario(text, 30, 20);
  if (!queries) return;
  for (const ScenarioQuery& q : *queries) {
    for (const Cell c : {q.start, q.goal}) fuzz::must(c.x >= 0 && c.x < 30 && c.y >= 0 && c.y < 20);
    fuzz::must(q.optimum >= 0 && q.rounding > 0);
  }
}

void read_map(std::string_view text) {
  const auto grid = read_movingai_map(text);
  if (!grid) return;
  fuzz::must(static_cast<std::size_t>(grid->width()) * static_cast<std::size_t>(grid->height()) <= text.size());
  fuzz::must(!grid->is_open({-1, 0}) && !grid->is_open({grid->width(), grid->height() - 1}));
}

void read_pgm(std::span<const std::uint8_t> bytes) {
  MapServerInfo info;
  info.negate = bytes.size() % 2 != 0;
  const auto cells = read_map_server_pgm(info, bytes);
  if (!cells) return;
  cells->for_each_brick([](BrickIndex index, const Brick& brick) {
    fuzz::must(index.z == 0 && index.x >= 0 && index.y >= 0);
    brick.for_each([](int local, LogOdds value) { fuzz::must(local < 64 && (value == kFree || value == kOccupied)); });
  });
}

}  // namespace

/// Any bytes as each of the grid files that people hand us; the first says which.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  switch (data[0] & 3) {
    case 0: read_map(text); break;
    case 1: read_scenario(text); break;
    case 2: read_pgm(bytes); break;
    default:
      if (const auto info = read_map_server_yaml(text)) fuzz::must(info->resolution > 0 && info->origin.allFinite());
  }
  return 0;
}
