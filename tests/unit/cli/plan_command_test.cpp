// `concord plan` on scenarios and on map_server's grids.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

class PlanCommand : public testing::Test {
 protected:
  struct Ran {
    int exit;
    std::string out;
    [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out); }
  };

  void SetUp() override {
    fs::create_directories(folder);
    // A wall with a gap at the top, and a cell that is shut in.
    write("a.map", "type octile\nheight 4\nwidth 7\nmap\n.......\n...@...\n...@.@.\n...@@.@\n");
    write("a.scen", "version 1\n0 a 7 4 0 0 6 0 6\n0 a 7 4 2 1 4 1 4\n0 a 7 4 0 0 1 1 1.41421356\n0 a 7 4 3 0 3 0 0\n");
    write("g.yaml",
          "image: g.pgm\nresolution: 0.5\norigin: [10, -5, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n");
    std::string picture = "P5\n40 20\n255\n";
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 40; ++x) picture += x == 20 && y > 5 ? '\0' : '\xfe';
    }
    write("g.pgm", picture);
  }
  void TearDown() override { fs::remove_all(folder); }

  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder / name; }

  Ran run(std::vector<std::string> arguments) {
    Program program;
    add_plan(program);
    arguments.insert(arguments.begin(), {"concord", "plan"});
    std::vector<const char*> argv;
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int exit = program.run(static_cast<int>(argv.size()), argv.data());
    (void)testing::internal::GetCapturedStderr();
    return {exit, testing::internal::GetCapturedStdout()};
  }

  fs::path folder = fs::temp_directory_path() / ("concord_plan_" + std::to_string(getpid()));
};

TEST_F(PlanCommand, AsksAllQueriesOfAScenario) {
  const Ran ran = run({"--map", file("a.map"), "--scen", file("a.scen"), "--json", "--paths", file("paths")});
  ASSERT_EQ(ran.exit, 0);
  const nlohmann::json figures = ran.json();
  EXPECT_EQ(figures["queries"], 4);
  EXPECT_EQ(figures["solved"], 4);
  EXPECT_EQ(figures["optimal"], 4);
  EXPECT_EQ(figures["off_goal"], 0);
  EXPECT_EQ(figures["invalid"], 0);
  EXPECT_NEAR(figures["worst_ratio"].get<double>(), 1, 1e-6);
  EXPECT_NEAR(figures["mean_ratio"].get<double>(), 1, 1e-6);
  for (const char* key : {"us_p50", "us_p99", "speedup_textbook", "prep_ms"}) EXPECT_GT(figures[key].get<double>(), 0);

  std::ifstream lines(folder / "paths");
  std::string line;
  std::vector<nlohmann::json> paths;
  while (std::getline(lines, line)) paths.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(paths.size(), 4U);
  EXPECT_EQ(paths[1]["query"], 1);
  EXPECT_EQ(paths[1]["status"], "OK");
  EXPECT_EQ(paths[1]["length"], 4);
  EXPECT_EQ(paths[1]["points"].front(), nlohmann::json({2, 1}));
  EXPECT_EQ(paths[1]["points"].back(), nlohmann::json({4, 1}));
}

TEST_F(PlanCommand, AtAnyAngleAndAwayFromWalls) {
  for (const char* how : {"--any-angle", "--clearance"}) {
    const Ran ran = run({"--map", file("a.map"), "--scen", file("a.scen"), "--json", how});
    ASSERT_EQ(ran.exit, 0) << ran.out;
    EXPECT_EQ(ran.json()["solved"], 4);
    EXPECT_EQ(ran.json()["invalid"], 0);
  }
}

TEST_F(PlanCommand, SaysWhereThereIsNoWay) {
  write("shut.scen", "version 1\n0 a 7 4 0 0 5 3 9\n");
  const Ran shut = run({"--map", file("a.map"), "--scen", file("shut.scen"), "--json", "--paths", file("paths")});
  EXPECT_EQ(shut.exit, 1);
  EXPECT_EQ(shut.json()["solved"], 0);
  std::ifstream lines(folder / "paths");
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(nlohmann::json::parse(line)["status"], "NO_VALID_PATH");
}

TEST_F(PlanCommand, RefusesWhatItCannotRead) {
  EXPECT_EQ(run({"--map", file("a.map"), "--scen", file("none")}).exit, 2);
  EXPECT_EQ(run({"--map", file("a.scen"), "--scen", file("a.scen")}).exit, 2);
  EXPECT_EQ(run({"--scen", file("a.scen")}).exit, 2);
  EXPECT_EQ(run({"--map", file("a.map"), "--scen", file("a.scen"), "--to", "1 1"}).exit, 2);
  EXPECT_EQ(run({"--map", file("a.map"), "--scen", file("a.scen"), "--any-angle", "--clearance"}).exit, 2);
  EXPECT_EQ(run({"--grid", file("a.map"), "--from", "1 1", "--to", "2 2"}).exit, 2);
  write("far.yaml", "image: none.pgm\nresolution: 0.5\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.2\n");
  EXPECT_EQ(run({"--grid", file("far.yaml"), "--from", "1 1", "--to", "2 2"}).exit, 2);
}

TEST_F(PlanCommand, GoesOverAMapServersGridInItsOwnFrame) {
  const std::vector<std::string> base{"--grid", file("g.yaml"), "--json", "--radius", "0.3", "--from", "12 -4 0.5"};
  auto with = [&](const std::string& to, std::vector<std::string> more = {}) {
    std::vector<std::string> all = base;
    all.insert(all.end(), {"--to", to});
    all.insert(all.end(), more.begin(), more.end());
    return run(all);
  };
  const Ran ran = with("28 -4 1.57", {"--out", file("path.png")});
  ASSERT_EQ(ran.exit, 0) << ran.out;
  const nlohmann::json path = ran.json();
  EXPECT_EQ(path["points"].front()[0], 12);
  EXPECT_EQ(path["points"].back()[0], 28);
  // Round the wall, whose upper end is at y = -5 + 14 * 0.5.
  double highest = -5;
  for (const auto& p : path["points"]) highest = std::max(highest, p[1].get<double>());
  EXPECT_GT(highest, 2);
  EXPECT_GE(path["least_clearance"].get<double>(), 0.3 - 1e-6);
  EXPECT_TRUE(fs::exists(folder / "path.png"));
  EXPECT_EQ(with("20.25 -4").json()["status"], "GOAL_OCCUPIED");
  EXPECT_EQ(with("9 -4").json()["status"], "GOAL_OUTSIDE_MAP");
  EXPECT_EQ(with("nan 1").exit, 2);
}

TEST_F(PlanCommand, ATurnRadiusThatIsNoneIsAFaultOfTheAsker) {
  for (const char* radius : {"nan", "-1", "0.001"}) {
    const Ran ran = run({"--grid", file("g.yaml"), "--json", "--footprint", "1.2x0.8", "--from", "12 -3 0.5", "--to",
                         "28 -3 1.57", "--turn-radius", radius});
    EXPECT_EQ(ran.exit, 2) << radius;
  }
}

TEST_F(PlanCommand, TakesAFootprint) {
  const std::vector<std::string> base{"--grid", file("g.yaml"), "--json",   "--turn-radius",
                                      "0.8",    "--from",       "12 -3 0.5"};
  auto with = [&](const std::string& footprint, const std::string& to, std::vector<std::string> more = {}) {
    std::vector<std::string> all = base;
    all.insert(all.end(), {"--footprint", footprint, "--to", to});
    all.insert(all.end(), more.begin(), more.end());
    return run(all);
  };
  const Ran ran = with("1.2x0.8", "28 -3 1.57", {"--picture", file("path.png"), "--paths", file("paths")});
  ASSERT_EQ(ran.exit, 0) << ran.out;
  const nlohmann::json path = ran.json();
  EXPECT_EQ(path["status"], "OK");
  EXPECT_EQ(path["points"].front(), nlohmann::json({12, -3, 0.5}));
  EXPECT_EQ(path["points"].back(), nlohmann::json({28, -3, 1.57}));
  EXPECT_GT(path["least_clearance"].get<double>(), 0);
  EXPECT_EQ(path["clearance"].size(), path["points"].size());
  EXPECT_TRUE(fs::exists(folder / "path.png"));
  std::ifstream lines(folder / "paths");
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(nlohmann::json::parse(line)["points"], path["points"]);
  const Ran polygon = with("-0.5 -0.4, 0.8 0, -0.5 0.4", "28 -3 1.57");
  EXPECT_EQ(polygon.exit, 0) << polygon.out;
  const Ran near = with("1.2x0.8", "20.1 -3 0");
  EXPECT_EQ(near.exit, 1);
  EXPECT_EQ(near.json()["status"], "GOAL_OCCUPIED");
  EXPECT_EQ(with("1.2x0.8", "19.7 -3 0").json()["status"], "GOAL_CLEARANCE");
  EXPECT_EQ(with("8x7.5", "28 -3 0").json()["status"], "START_CLEARANCE");
  EXPECT_EQ(with("1.2x0.8", "9e9 -3 0").json()["status"], "GOAL_OUTSIDE_MAP");
  for (const char* bad : {"1.2", "nanx1", "0 0, 1 1", "-1 -1, 1 1, 1 -1, -1 1", "1e99x1"}) {
    EXPECT_EQ(with(bad, "28 -3 1.57").exit, 2) << bad;
  }
  EXPECT_EQ(with("1.2x0.8", "nan -3 0").exit, 2);
  EXPECT_EQ(with("1.2x0.8", "28 -3 0", {"--radius", "0.3"}).exit, 2);
}

TEST_F(PlanCommand, WritesTheOnePathOfARoundRobot) {
  const Ran ran = run({"--grid", file("g.yaml"), "--json", "--radius", "0.3", "--from", "12 -4", "--to", "28 -4",
                       "--paths", file("paths")});
  ASSERT_EQ(ran.exit, 0) << ran.out;
  std::ifstream lines(folder / "paths");
  std::string line;
  std::getline(lines, line);
  const nlohmann::json path = nlohmann::json::parse(line);
  EXPECT_EQ(path["status"], "OK");
  EXPECT_EQ(path["points"].front(), nlohmann::json({12, -4}));
  EXPECT_EQ(path["radius"], 0.3);
}

}  // namespace
}  // namespace concord
