// Every query of other people's maps, and the shortest ways at any angle: ../shared/data, whose README names the
// sources.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>

#include <gtest/gtest.h>

#include "planner/scenario/scenario.hpp"
#include "shared_maps.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Those of one map, with the shortest length at any angle as the optimum. Corners may be touched there.
std::vector<ScenarioQuery> any_angle_queries(const fs::path& csv, const std::string& map) {
  std::vector<ScenarioQuery> queries;
  std::istringstream lines(read(csv));
  for (std::string line; std::getline(lines, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    std::string name;
    double index = 0, octile = 0;
    ScenarioQuery q;
    if (fields >> name >> index >> q.start.x >> q.start.y >> q.goal.x >> q.goal.y >> octile >> q.optimum &&
        name == map) {
      queries.push_back(q);
    }
  }
  return queries;
}

class AllQueries : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!fs::exists(map())) GTEST_SKIP() << "SKIPPED: no " << map() << " (real data stays outside the repository)";
    auto read_grid = read_movingai_map(read(map()));
    ASSERT_TRUE(read_grid) << read_grid.error().message;
    grid_.emplace(std::move(*read_grid));
  }
  [[nodiscard]] fs::path map() const { return fs::path(CONCORD_SHARED_DATA) / GetParam(); }

  std::optional<OpenGrid> grid_;
};

void expect_all_good(const ScenarioResult& result) {
  EXPECT_GT(result.paths.size(), 0U);
  EXPECT_EQ(result.solved, result.paths.size());
  EXPECT_EQ(result.off_goal, 0U);
  EXPECT_EQ(result.invalid, 0U);
}

TEST_P(AllQueries, AreAnsweredByTheShortestPath) {
  const auto queries = read_movingai_scenario(read(map().string() + ".scen"), grid_->width(), grid_->height());
  ASSERT_TRUE(queries) << queries.error().message;
  const ScenarioResult result = run_scenario(*grid_, *queries, Method::kFast, {.rounds = 0});
  expect_all_good(result);
  EXPECT_EQ(result.optimal, result.paths.size());
}

TEST_P(AllQueries, AreAnsweredAtAnyAngle) {
  const auto queries = any_angle_queries(fs::path(CONCORD_SHARED_DATA) / "anyangle_optima.csv", map().filename());
  const ScenarioResult result = run_scenario(*grid_, queries, Method::kAnyAngle, {.rounds = 0});
  expect_all_good(result);
  for (std::size_t i = 0; i < result.paths.size(); ++i) {
    EXPECT_GE(result.paths[i].length, queries[i].optimum - 1e-5) << "shorter than the shortest: " << i;
  }
  // What it costs to keep off the corners, which these lengths touch, is a matter of how narrow the map is.
  EXPECT_LE(result.mean_ratio, map().parent_path().filename() == "buildings_conf" ? 1.002 : 1.07);
}

TEST_P(AllQueries, AreAnsweredAwayFromWalls) {
  auto queries = any_angle_queries(fs::path(CONCORD_SHARED_DATA) / "anyangle_optima.csv", map().filename());
  queries.resize(std::min<std::size_t>(queries.size(), 40));
  expect_all_good(run_scenario(*grid_, queries, Method::kClearance, {.rounds = 0}));
}

INSTANTIATE_TEST_SUITE_P(Shared, AllQueries, shared_maps(), [](const auto& map) { return map_name(map); });

}  // namespace
}  // namespace concord
