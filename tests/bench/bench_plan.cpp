// Searches on grids: ../shared/data, against a textbook A* and, where it is installed, Warthog's JPS. See README.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <sstream>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "planner/scenario/scenario.hpp"
#include "pose_figures.hpp"
#include "replan_figures.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kTextbook = 200;

struct Case {
  std::string name;
  fs::path map;
  OpenGrid grid;
  std::vector<ScenarioQuery> queries;
};

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<Case> load(const fs::path& folder) {
  std::vector<Case> cases;
  std::vector<fs::path> maps;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".map") maps.push_back(entry.path());
  }
  std::sort(maps.begin(), maps.end());
  for (const fs::path& map : maps) {
    auto grid = read_movingai_map(read(map));
    if (!grid) throw std::runtime_error(map.string() + ": " + grid.error().message);
    auto queries = read_movingai_scenario(read(map.string() + ".scen"), grid->width(), grid->height());
    if (!queries) throw std::runtime_error(map.string() + ".scen: " + queries.error().message);
    cases.push_back({map.stem().string(), map, std::move(*grid), std::move(*queries)});
  }
  return cases;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(static_cast<std::size_t>(share * static_cast<double>(values.size())), values.size() - 1)];
}

double geometric_mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += std::log(value);
  return values.empty() ? 0 : std::exp(sum / static_cast<double>(values.size()));
}

/// What Warthog says each query took, microseconds; empty if it is not there.
std::vector<double> warthog_us(const std::string& program, const std::string& algorithm, const fs::path& map) {
  if (program.empty()) return {};
  const std::string command = "'" + program + "' --alg " + algorithm + " --map '" + map.string() + "' --scen '" +
                              map.string() + ".scen' 2>/dev/null";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::vector<double> us;
  std::array<char, 4096> line;
  while (pipe && std::fgets(line.data(), line.size(), pipe.get()) != nullptr) {
    std::istringstream fields(line.data());
    std::string field;
    for (int i = 0; i < 8; ++i) std::getline(fields, field, '\t');
    if (!field.empty() && std::isdigit(static_cast<unsigned char>(field.front())) != 0)
      us.push_back(std::stod(field) / 1e3);
  }
  return us;
}

/// Of several maps together.
struct Sums {
  std::vector<double> us, speedups;                    ///< of the fast path: by query, by query of the sample
  std::map<std::string, std::vector<double>> warthog;  ///< its time over ours, by algorithm and query
  double worst_p99_over_p50 = 0;
  std::vector<double> clearance, replan;  ///< time over that of a uniform A*; over that from scratch
  std::size_t queries = 0, solved = 0, optimal = 0, off_goal = 0, invalid = 0, wrong_replans = 0;
};

json bench_fast(const Case& c, const std::string& warthog, Sums& sums) {
  const ScenarioResult r = run_scenario(c.grid, c.queries, Method::kFast, {.textbook = kTextbook});
  sums.queries += r.paths.size();
  sums.solved += r.solved;
  sums.optimal += r.optimal;
  sums.off_goal += r.off_goal;
  sums.invalid += r.invalid;
  sums.us.insert(sums.us.end(), r.us.begin(), r.us.end());
  for (std::size_t i = 0; i < r.sample.size(); ++i) sums.speedups.push_back(r.textbook_us[i] / r.us[r.sample[i]]);
  sums.worst_p99_over_p50 = std::max(sums.worst_p99_over_p50, r.us_at(0.99) / r.us_at(0.5));
  json figures{{"queries", r.paths.size()},
               {"optimal", r.optimal},
               {"us_p50", r.us_at(0.5)},
               {"us_p99", r.us_at(0.99)},
               {"prep_ms", r.prep_ms},
               {"speedup_textbook", r.speedup_textbook()},
               {"textbook_us_p50", quantile(r.textbook_us, 0.5)},
               {"textbook_us_p99", quantile(r.textbook_us, 0.99)}};
  for (const char* algorithm : {"jps", "jps2", "jps+", "jps2+"}) {
    const std::vector<double> theirs = warthog_us(warthog, algorithm, c.map);
    if (theirs.size() != r.us.size()) continue;
    std::vector<double> ratios;
    for (std::size_t i = 0; i < theirs.size(); ++i) ratios.push_back(theirs[i] / r.us[i]);
    figures["warthog"][algorithm] = {{"us_p50", quantile(theirs, 0.5)}, {"times_as_fast", geometric_mean(ratios)}};
    std::vector<double>& all = sums.warthog[algorithm];
    all.insert(all.end(), ratios.begin(), ratios.end());
  }
  return figures;
}

/// Queries with the length of the shortest path at any angle in place of their optimum, by the map's file.
std::map<std::string, std::vector<ScenarioQuery>> read_optima(const fs::path& csv) {
  std::map<std::string, std::vector<ScenarioQuery>> optima;
  std::istringstream lines(read(csv));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    std::string map;
    int index = 0;
    double octile = 0;
    ScenarioQuery q;
    if (fields >> map >> index >> q.start.x >> q.start.y >> q.goal.x >> q.goal.y >> octile >> q.optimum) {
      optima[map].push_back(q);
    }
  }
  return optima;
}

json bench_any_angle(const Case& c, const std::vector<ScenarioQuery>& optima) {
  const ScenarioResult r = run_scenario(c.grid, optima, Method::kAnyAngle, {.textbook = kTextbook});
  return {{"mean_ratio", r.mean_ratio}, {"worst_ratio", r.worst_ratio}, {"invalid", r.invalid},
          {"solved", r.solved},         {"queries", r.paths.size()},    {"us_p50", r.us_at(0.5)},
          {"us_p99", r.us_at(0.99)},    {"prep_ms", r.prep_ms},         {"speedup_textbook", r.speedup_textbook()}};
}

json bench_clearance(const Case& c, Sums& sums) {
  std::vector<ScenarioQuery> some;
  const std::size_t stride = (c.queries.size() + kTextbook - 1) / kTextbook;
  for (std::size_t i = 0; i < c.queries.size(); i += stride) some.push_back(c.queries[i]);
  const ScenarioResult r = run_scenario(c.grid, some, Method::kClearance, {.textbook = kTextbook});
  double ours = 0, uniform = 0;
  for (std::size_t i = 0; i < r.sample.size(); ++i) {
    ours += r.us[r.sample[i]];
    uniform += r.textbook_us[i];
    sums.clearance.push_back(r.us[r.sample[i]] / r.textbook_us[i]);
  }
  return {{"times_uniform", 1 / r.speedup_textbook()},
          {"times_uniform_of_sums", ours / uniform},
          {"invalid", r.invalid},
          {"us_p50", r.us_at(0.5)},
          {"us_p99", r.us_at(0.99)},
          {"prep_ms", r.prep_ms}};
}

json bench_replan(const Case& c, Sums& sums) {
  const ReplanFigures r = replan_figures(c.grid, c.queries);
  std::vector<double> ratios;
  for (std::size_t i = 0; i < r.follow_us.size(); ++i) ratios.push_back(r.follow_us[i] / r.scratch_us[i]);
  sums.replan.insert(sums.replan.end(), ratios.begin(), ratios.end());
  sums.wrong_replans += r.wrong;
  return {{"p50_over_scratch", quantile(ratios, 0.5)},
          {"p99_over_scratch", quantile(ratios, 0.99)},
          {"us_p50", quantile(r.follow_us, 0.5)},
          {"us_p99", quantile(r.follow_us, 0.99)},
          {"scratch_us_p50", quantile(r.scratch_us, 0.5)},
          {"improve_us_p50", quantile(r.improve_us, 0.5)},
          {"improve_us_p99", quantile(r.improve_us, 0.99)},
          {"improved", r.improved},
          {"kept", r.kept},
          {"repaired", r.repaired},
          {"anew", r.anew},
          {"unreachable", r.unreachable},
          {"wrong", r.wrong},
          {"worst_cost", r.worst_cost}};
}

json to_json(const Sums& sums) {
  json figures{{"queries", sums.queries},
               {"solved", sums.solved},
               {"optimal", sums.optimal},
               {"off_goal", sums.off_goal},
               {"invalid", sums.invalid},
               {"us_p50", quantile(sums.us, 0.5)},
               {"us_p99", quantile(sums.us, 0.99)},
               {"worst_p99_over_p50", sums.worst_p99_over_p50},
               {"speedup_textbook", geometric_mean(sums.speedups)},
               {"clearance_times_uniform", geometric_mean(sums.clearance)},
               {"replan_p50_over_scratch", quantile(sums.replan, 0.5)},
               {"replan_p99_over_scratch", quantile(sums.replan, 0.99)},
               {"wrong_replans", sums.wrong_replans}};
  for (const auto& [algorithm, ratios] : sums.warthog) figures["times_warthog"][algorithm] = geometric_mean(ratios);
  return figures;
}

json bench(const fs::path& data, const std::string& folder, const std::string& warthog, bool quiet) {
  const auto optima = read_optima(data / "anyangle_optima.csv");
  Sums sums;
  json maps;
  for (const Case& c : load(data / folder)) {
    json& figures = maps[c.name];
    figures["fast"] = bench_fast(c, warthog, sums);
    if (const auto found = optima.find(c.map.filename().string()); found != optima.end()) {
      figures["any_angle"] = bench_any_angle(c, found->second);
    }
    figures["clearance"] = bench_clearance(c, sums);
    figures["replan"] = bench_replan(c, sums);
    if (!quiet) std::printf("%s %s\n", c.name.c_str(), figures.dump().c_str());
  }
  json figures = to_json(sums);
  if (!quiet) std::printf("%s in all %s\n\n", folder.c_str(), figures.dump().c_str());
  figures["maps"] = std::move(maps);
  return figures;
}

/// A robot of 1.2 x 0.8 m that turns with 0.4 m, twenty queries of each building.
json bench_poses(const fs::path& data, bool quiet) {
  constexpr double kTurnRadius = 0.4;
  std::size_t queries = 0, solved = 0, violations = 0, sampled = 0;
  std::vector<double> ms, check_ms, startup_ms;
  json maps;
  for (const PoseCase& c : pose_cases(data, 20)) {
    const PoseFigures f = pose_figures(c, kTurnRadius);
    maps[c.name] = {{"se2_queries", c.queries.size()},          {"se2_solved", f.solved},
                    {"se2_violations", f.violations},           {"se2_sampled", f.sampled},
                    {"se2_startup_ms", f.startup_ms},           {"se2_ms_p50", quantile(f.ms, 0.5)},
                    {"se2_ms_p99", quantile(f.ms, 0.99)},       {"se2_check_ms_p50", quantile(f.check_ms, 0.5)},
                    {"se2_metres_p50", quantile(f.length, 0.5)}};
    if (!quiet) std::printf("%s %s\n", c.name.c_str(), maps[c.name].dump().c_str());
    queries += c.queries.size();
    solved += f.solved;
    violations += f.violations;
    sampled += f.sampled;
    ms.insert(ms.end(), f.ms.begin(), f.ms.end());
    check_ms.insert(check_ms.end(), f.check_ms.begin(), f.check_ms.end());
    startup_ms.push_back(f.startup_ms);
  }
  json figures{{"se2_queries", queries},
               {"se2_solved", solved},
               {"se2_violations", violations},
               {"se2_sampled", sampled},
               {"se2_startup_ms", quantile(startup_ms, 1)},
               {"se2_ms_p50", quantile(ms, 0.5)},
               {"se2_ms_p99", quantile(ms, 0.99)},
               {"se2_check_ms_p50", quantile(check_ms, 0.5)}};
  if (!quiet) std::printf("poses in all %s\n\n", figures.dump().c_str());
  figures["maps"] = std::move(maps);
  return figures;
}

}  // namespace
}  // namespace concord

int main(int argc, char** argv) {
  using namespace concord;
  CLI::App app("Searches on grids against a textbook A*", "bench_plan");
  bool as_json = false;
  std::string data = CONCORD_SHARED_DATA;
  std::string warthog = CONCORD_WARTHOG_JPS;
  app.add_flag("--json", as_json, "one JSON object instead of lines");
  app.add_option("--data", data, "holds buildings, buildings_conf, movingai and anyangle_optima.csv");
  app.add_option("--warthog", warthog, "the program warthog-jps; the CMake variable CONCORD_WARTHOG_JPS, if not given");
  CLI11_PARSE(app, argc, argv);
  try {
    nlohmann::json figures;
    for (const char* folder : {"buildings_conf", "movingai"}) figures[folder] = bench(data, folder, warthog, as_json);
    figures["poses"] = bench_poses(data, as_json);
    if (as_json) std::printf("%s\n", figures.dump(2).c_str());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_plan: %s\n", e.what());
    return 2;
  }
  return 0;
}
