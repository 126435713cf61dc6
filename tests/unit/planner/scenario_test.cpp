// Other people's maps and optimal lengths: ../shared/data, whose README names the sources.
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "planner/plan.hpp"
#include "planner/search.hpp"
#include "shared_maps.hpp"
#include "sketch.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

struct Query {
  Cell start, goal;
  double optimum = 0;
  double rounding = 0;  ///< the optimum is given to so many cells
};

std::vector<std::string> read_map(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  while (std::getline(in, line) && line.rfind("map", 0) != 0) {
  }
  std::vector<std::string> rows;
  while (std::getline(in, line)) {
    for (char& c : line) c = c == '.' || c == 'G' || c == 'S' ? '.' : '#';
    rows.push_back(line);
  }
  return rows;
}

std::vector<Query> read_queries(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  std::vector<Query> queries;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    std::string bucket, map, width, height, optimum;
    Query q;
    if (fields >> bucket >> map >> width >> height >> q.start.x >> q.start.y >> q.goal.x >> q.goal.y >> optimum) {
      const std::size_t point = std::min(optimum.find('.'), optimum.size() - 1);
      q.optimum = std::stod(optimum);
      q.rounding = 1e-6 + 0.6 * std::pow(10.0, -static_cast<double>(optimum.size() - 1 - point));
      queries.push_back(q);
    }
  }
  return queries;
}

class Scenario : public testing::TestWithParam<const char*> {};

TEST_P(Scenario, OptimaAreMetAndPathsAreSafe) {
  const fs::path map = fs::path(CONCORD_SHARED_DATA) / GetParam();
  const fs::path scen = map.string() + ".scen";
  if (!fs::exists(map) || !fs::exists(scen))
    GTEST_SKIP() << "SKIPPED: no " << map << " (real data stays outside the repository)";
  const Grid grid = test::sketch(read_map(map));
  const std::vector<Query> queries = read_queries(scen);
  ASSERT_FALSE(queries.empty());
  FreeSpace space(grid, 0);
  const std::size_t stride = std::max<std::size_t>(1, queries.size() / 40);
  for (std::size_t i = 0; i < queries.size(); i += stride) {
    const Query& q = queries[i];
    const Anchor start{q.start, 0};
    const Anchor goal{q.goal, 0};
    const CellPath path = find_path(space, {&start, 1}, {&goal, 1}, kMaxExpanded);
    ASSERT_EQ(path.status, CellPath::Status::kFound) << "query " << i;
    ASSERT_NEAR(static_cast<double>(path.cost) / kStraight, q.optimum, q.rounding) << "query " << i;
    const PlanResult any_angle = plan(grid, {q.start.x + 0.5, q.start.y + 0.5}, {q.goal.x + 0.5, q.goal.y + 0.5}, 0.0);
    ASSERT_EQ(any_angle.reason, Reason::kOk) << "query " << i << ": " << any_angle.message;
    ASSERT_LE(any_angle.length, q.optimum + q.rounding) << "query " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Shared, Scenario, shared_maps(), [](const auto& map) { return map_name(map); });

}  // namespace
}  // namespace concord
