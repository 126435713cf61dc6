#include "cli/plan_scenario.hpp"

#include <nlohmann/json.hpp>

#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

constexpr std::size_t kMaxFile = 500'000'000;
/// Queries that are asked of the textbook search, too; it takes a thousand times as long.
constexpr std::size_t kTextbook = 200;

Result<std::string> read_text(const std::string& file) {
  return read_whole_file(file, kMaxFile).map([](const Bytes& bytes) {
    return std::string(bytes.begin(), bytes.end());
  });
}

Error in_file(const std::string& file, const Error& error) { return {error.code, file + ": " + error.message}; }

struct Scenario {
  OpenGrid grid;
  std::vector<ScenarioQuery> queries;
};

Result<Scenario> load(const ScenarioOptions& options) {
  const auto map = read_text(options.map);
  if (!map) return tl::unexpected(map.error());
  auto grid = read_movingai_map(*map);
  if (!grid) return tl::unexpected(in_file(options.map, grid.error()));
  const auto text = read_text(options.scenario);
  if (!text) return tl::unexpected(text.error());
  auto queries = read_movingai_scenario(*text, grid->width(), grid->height());
  if (!queries) return tl::unexpected(in_file(options.scenario, queries.error()));
  return Scenario{std::move(*grid), std::move(*queries)};
}

std::string to_lines(const ScenarioResult& result) {
  std::string lines;
  for (std::size_t i = 0; i < result.paths.size(); ++i) {
    const ScenarioPath& path = result.paths[i];
    nlohmann::json line{{"query", i}, {"status", path.is_found ? "OK" : "NO_VALID_PATH"}};
    if (path.is_found) {
      nlohmann::json points = nlohmann::json::array();
      for (const Cell cell : path.turns) points.push_back({cell.x, cell.y});
      line["length"] = path.length;
      line["points"] = std::move(points);
    }
    lines += line.dump() + '\n';
  }
  return lines;
}

nlohmann::json to_json(const ScenarioResult& result) {
  return {{"queries", result.paths.size()},
          {"solved", result.solved},
          {"optimal", result.optimal},
          {"worst_ratio", result.worst_ratio},
          {"mean_ratio", result.mean_ratio},
          {"off_goal", result.off_goal},
          {"invalid", result.invalid},
          {"us_p50", result.us_at(0.5)},
          {"us_p99", result.us_at(0.99)},
          {"speedup_textbook", result.speedup_textbook()},
          {"textbook_queries", result.sample.size()},
          {"prep_ms", result.prep_ms}};
}

std::string to_words(const ScenarioResult& result) {
  return "queries   " + format_count(static_cast<std::int64_t>(result.paths.size())) + "\nsolved    " +
         format_count(static_cast<std::int64_t>(result.solved)) + "\noptimal   " +
         format_count(static_cast<std::int64_t>(result.optimal)) + " by steps in eight directions\nratio     " +
         format_number(result.mean_ratio, 4) + " mean, " + format_number(result.worst_ratio, 4) + " worst\noff goal  " +
         format_count(static_cast<std::int64_t>(result.off_goal)) + "\ninvalid   " +
         format_count(static_cast<std::int64_t>(result.invalid)) + "\ntime      " +
         format_number(result.us_at(0.5), 1) + " us median, " + format_number(result.us_at(0.99), 1) +
         " us 99th percentile, " + format_number(result.speedup_textbook(), 0) +
         " times as fast as a textbook A*\nprepared  in " + format_number(result.prep_ms, 1) + " ms";
}

}  // namespace

Outcome plan_scenario(const ScenarioOptions& options, const Common& common) {
  const auto scenario = load(options);
  if (!scenario) return fail(scenario.error());
  const ScenarioResult result =
      run_scenario(scenario->grid, scenario->queries, options.method, {.textbook = kTextbook});
  if (!options.paths.empty()) {
    const auto written = write_file(options.paths, to_lines(result));
    if (!written) return fail(written.error());
  }
  common.print(to_json(result), to_words(result));
  const bool is_good = result.solved == result.paths.size() && result.off_goal == 0 && result.invalid == 0;
  return is_good ? Exit::kDone : Exit::kNegative;
}

}  // namespace concord
