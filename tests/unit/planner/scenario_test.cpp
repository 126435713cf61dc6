// Other people's maps and optimal lengths: ../shared/data, whose README names the sources.
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "planner/plan.hpp"
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
  RobotGrids grids(grid, 1);
  const RobotTask task{grids, 0.0};
  const std::size_t stride = std::max<std::size_t>(1, queries.size() / 40);
  for (std::size_t i = 0; i < queries.size(); i += stride) {
    const Query& q = queries[i];
    const auto robot = grids.at(0.0, Ignoring::kNothing, *grids.areas().around(q.start));
    const auto shortest = robot->paths().fast(robot->local(q.start), robot->local(q.goal));
    ASSERT_TRUE(shortest) << "query " << i;
    ASSERT_NEAR(static_cast<double>(shortest->cost) / kStraight, q.optimum, q.rounding) << "query " << i;
    const auto found = Route(centre_of(q.start), {}, centre_of(q.goal)).find(task, 1);
    ASSERT_TRUE(found);
    const PlanResult result = finish(task, *found);
    ASSERT_EQ(result.reason, Reason::kOk) << "query " << i << ": " << result.message;
    ASSERT_LE(result.length, 3 * (q.optimum + q.rounding)) << "query " << i;  // nothing costs more than three times
  }
}

INSTANTIATE_TEST_SUITE_P(Shared, Scenario, shared_maps(), [](const auto& map) { return map_name(map); });

}  // namespace
}  // namespace concord
