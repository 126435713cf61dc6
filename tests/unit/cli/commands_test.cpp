#include <unistd.h>

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/map_file.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

/// A box of voxels, both corners included.
void fill(BrickMap& map, VoxelIndex low, VoxelIndex high, LogOdds value) {
  std::map<BrickIndex, DenseBrick> dense;
  for (VoxelIndex v = low; v.z <= high.z; ++v.z) {
    for (v.y = low.y; v.y <= high.y; ++v.y) {
      for (v.x = low.x; v.x <= high.x; ++v.x) {
        const auto [it, fresh] = dense.try_emplace(brick_of(v));
        const Brick* known = map.find(it->first);
        if (fresh) known != nullptr ? known->to_dense(it->second) : it->second.fill(kUnknown);
        it->second[local_of(v)] = value;
      }
    }
  }
  for (const auto& [index, values] : dense) map.set(index, Brick::from_dense(values));
}

/// Runs `concord` in this process, on files of a folder of its own.
class Commands : public testing::Test {
 protected:
  struct Ran {
    int exit;
    std::string out;
    std::string err;
    [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out); }
  };

  void SetUp() override {
    fs::create_directories(folder);
    // A room of 4 x 2 m at 0.1 m with a wall across it that leaves a door at y < 0.6.
    BrickMap room;
    fill(room, {0, 0, 0}, {39, 19, 9}, kFree);
    fill(room, {20, 6, 0}, {20, 19, 9}, kOccupied);
    ASSERT_TRUE(save_map(folder / "room.bt", room, 0.1));
    BrickMap pillar;
    fill(pillar, {0, 0, 0}, {1, 1, 9}, kOccupied);
    fill(pillar, {2, 0, 0}, {3, 1, 9}, kFree);
    ASSERT_TRUE(save_map(folder / "pillar.bt", pillar, 0.1));
  }
  void TearDown() override { fs::remove_all(folder); }

  [[nodiscard]] std::string file(const std::string& name) const { return folder / name; }

  Ran run(const std::vector<std::string>& arguments) {
    Program program;
    for (const auto add :
         {add_info, add_merge, add_project, add_plan, add_edit, add_requests, add_goals, add_downsample, add_up,
          add_zones, add_leases, add_history, add_conflicts, add_agent_corrections, add_saved_maps})
      add(program);
    std::vector<const char*> argv = {"concord"};
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int exit = program.run(static_cast<int>(argv.size()), argv.data());
    return {exit, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
  }

  fs::path folder = fs::path(testing::TempDir()) / ("commands" + std::to_string(getpid()));
};

TEST_F(Commands, InfoCountsWhatAFileHolds) {
  const Ran ran = run({"info", file("room.bt"), "--json"});
  EXPECT_EQ(ran.exit, 0);
  const nlohmann::json json = ran.json();
  EXPECT_EQ(json["known"], 40 * 20 * 10);
  EXPECT_EQ(json["occupied"], 14 * 10);
  EXPECT_EQ(json["free"], 40 * 20 * 10 - 14 * 10);
  EXPECT_NEAR(json["bounds"]["max"][0].get<double>(), 4.0, 1e-9);
}

TEST_F(Commands, AFileThatCannotBeReadIsToldInTheFormAskedFor) {
  const Ran words = run({"info", file("none.bt")});
  EXPECT_EQ(words.exit, 2);
  EXPECT_EQ(words.out, "");
  EXPECT_NE(words.err.find("No such file"), std::string::npos);
  std::ofstream(file("bad.bt")) << "no map";
  const Ran json = run({"info", file("bad.bt"), "--json"});
  EXPECT_EQ(json.exit, 2);
  EXPECT_EQ(json.json()["error"]["code"], "MALFORMED");
}

TEST_F(Commands, WrongUsageIsTwoAndHelpIsNone) {
  EXPECT_EQ(run({}).exit, 2);
  EXPECT_EQ(run({"nonsense"}).exit, 2);
  EXPECT_EQ(run({"merge", file("room.bt")}).exit, 2);
  EXPECT_EQ(run({"merge", file("room.bt"), file("pillar.bt"), "--policy", "loudest"}).exit, 2);
  EXPECT_EQ(run({"info", "--help"}).exit, 0);
}

TEST_F(Commands, MergePutsTheSecondMapWhereItIsTold) {
  const Ran ran = run({"merge", file("room.bt"), file("pillar.bt"), "--transform", "1 1 0 0 0 0 1", "--policy", "table",
                       "--out", file("merged.bt"), "--json"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  EXPECT_EQ(ran.json()["occupied"], 14 * 10 + 40);
  EXPECT_EQ(ran.json()["conflicting"], 40);
  const auto merged = load_map(file("merged.bt"));
  ASSERT_TRUE(merged);
  EXPECT_TRUE(is_occupied(merged->map.at({10, 10, 0})));
  EXPECT_TRUE(is_free(merged->map.at({12, 10, 0})));
}

TEST_F(Commands, MergeWeighsByWeight) {
  // Mean of -2.0 and +3.5: occupied with equal weights, free when the map that says free weighs twice as much.
  const auto occupied = [&](const std::vector<std::string>& extra) {
    std::vector<std::string> arguments = {"merge", file("room.bt"), file("pillar.bt"), "--json"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return run(arguments).json()["occupied"].get<int>();
  };
  EXPECT_EQ(occupied({}), 14 * 10 + 40);
  EXPECT_EQ(occupied({"--weights", "2", "1"}), 14 * 10);
}

TEST_F(Commands, MergeRefusesATransformThatIsNone) {
  for (const char* transform : {"1 2 3", "0 0 0 0 0 0 0", "nan 0 0 0 0 0 1"}) {
    EXPECT_EQ(run({"merge", file("room.bt"), file("pillar.bt"), "--transform", transform}).exit, 2) << transform;
  }
}

TEST_F(Commands, MergeRefusesToLoseWhatLiesBeyondTheBounds) {
  // At 0.1 m the map ends at 3276.8 m; the pillar is 0.4 m wide.
  const auto merged = [&](const char* transform) {
    return run(
        {"merge", file("room.bt"), file("pillar.bt"), "--transform", transform, "--out", file("m.bt"), "--json"});
  };
  const Ran beyond = merged("3276.8 0 0 0 0 0 1");
  EXPECT_EQ(beyond.exit, 2);
  EXPECT_EQ(beyond.json()["error"]["code"], "OUT_OF_BOUNDS");
  EXPECT_FALSE(fs::exists(file("m.bt")));
  EXPECT_EQ(merged("3275.2 0 0 0 0 0 1").json()["occupied"], 14 * 10 + 40);
}

TEST_F(Commands, MergeLeavesNoFileWithAnUnknownExtension) {
  EXPECT_EQ(run({"merge", file("room.bt"), file("pillar.bt"), "--out", file("m.png")}).exit, 2);
  EXPECT_FALSE(fs::exists(file("m.png")));
}

TEST_F(Commands, ProjectWritesWhatMapServerReads) {
  const Ran ran = run({"project", file("room.bt"), "--band", "0", "1", "--out", file("grid.pgm"), "--json"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  EXPECT_EQ(ran.json()["occupied"], 14);
  EXPECT_EQ(ran.json()["free"], 40 * 20 - 14);
  EXPECT_EQ(ran.json()["unknown"], 0);
  std::ifstream pgm(file("grid.pgm"), std::ios::binary);
  std::string magic;
  int width = 0, height = 0, most = 0;
  pgm >> magic >> width >> height >> most;
  pgm.get();
  std::vector<char> cells(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  pgm.read(cells.data(), static_cast<std::streamsize>(cells.size()));
  ASSERT_TRUE(pgm);
  EXPECT_EQ(magic, "P5");
  EXPECT_EQ(width, 40);
  EXPECT_EQ(height, 20);
  EXPECT_EQ(static_cast<unsigned char>(cells[20]), 0) << "the top row is the far end of the wall";
  EXPECT_EQ(static_cast<unsigned char>(cells[19 * 40 + 20]), 254) << "the bottom row is the door";
  std::ifstream yaml(file("grid.yaml"));
  const std::string text((std::istreambuf_iterator<char>(yaml)), {});
  EXPECT_NE(text.find("resolution: 0.1\norigin: [0, 0, 0]"), std::string::npos) << text;
}

TEST_F(Commands, ProjectRefusesABandWithNothingInIt) {
  EXPECT_EQ(run({"project", file("room.bt"), "--band", "-9", "-8"}).exit, 2);
  EXPECT_EQ(run({"project", file("room.bt"), "--band", "1", "0"}).exit, 2);
}

TEST_F(Commands, PlanGoesThroughTheDoorOrSaysWhyNot) {
  const std::vector<std::string> base = {"plan",   "--map", file("room.bt"), "--band", "0",     "1",
                                         "--from", "1 1.5", "--to",          "3 1.5",  "--json"};
  auto with = [&](const std::vector<std::string>& extra) {
    std::vector<std::string> all = base;
    all.insert(all.end(), extra.begin(), extra.end());
    return run(all);
  };
  const Ran narrow = with({"--radius", "0.2", "--out", file("path.png")});
  EXPECT_EQ(narrow.exit, 0) << narrow.err;
  EXPECT_EQ(narrow.json()["status"], "OK");
  EXPECT_GT(narrow.json()["length"].get<double>(), 2.5);
  EXPECT_GT(fs::file_size(file("path.png")), 1000U);
  const Ran wide = with({"--radius", "0.4"});
  EXPECT_EQ(wide.exit, 1);
  EXPECT_EQ(wide.json()["status"], "NO_VALID_PATH");
  EXPECT_TRUE(wide.json()["length"].is_null());
}

TEST_F(Commands, PlanTakesBandAndRadiusFromTheSiteAndSaysPointsInSpace) {
  std::ofstream(file("site.yaml")) << "planner: {zmin: 0, zmax: 1}\nagents: {unlisted: {radius: 0.4}}\n";
  const std::vector<std::string> base = {"plan", "--map", file("room.bt"), "--from", "1 1.5",
                                         "--to", "3 1.5", "--json",        "--site", file("site.yaml")};
  EXPECT_EQ(run(base).json()["status"], "NO_VALID_PATH");
  std::vector<std::string> narrow = base;
  narrow.insert(narrow.end(), {"--radius", "0.2"});
  const nlohmann::json path = run(narrow).json();
  EXPECT_EQ(path["status"], "OK");
  EXPECT_EQ(path["points"].front().size(), 3U);
  narrow.back() = "0";
  EXPECT_EQ(run(narrow).exit, 2) << "on the wire it would mean the site's";
}

TEST_F(Commands, PlanNeedsAMapOrARobot) {
  EXPECT_EQ(run({"plan", "--to", "1 1"}).exit, 2);
  EXPECT_EQ(run({"plan", "--to", "1 1", "--map", file("room.bt")}).exit, 2);
  EXPECT_EQ(run({"plan", "--to", "1", "--robot", "robot1"}).exit, 2);
  EXPECT_EQ(run({"plan", "--to", "1 1", "--robot", "../robot"}).exit, 2);
}

TEST_F(Commands, UsageIsToldInTheFormAskedFor) {
  const Ran ran = run({"merge", "--json", file("room.bt")});
  EXPECT_EQ(ran.exit, 2);
  EXPECT_EQ(ran.json()["error"]["code"], "USAGE");
  EXPECT_EQ(ran.err, "");
}

TEST_F(Commands, WrongUsageIsToldAsEveryFailureIs) {
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{}, {"nonsense"}, {"info"}}) {
    const Ran ran = run(wrong);
    EXPECT_EQ(ran.out, "");
    EXPECT_EQ(ran.err.rfind("concord: ", 0), 0U) << ran.err;
    EXPECT_NE(ran.err.find("--help (USAGE)"), std::string::npos) << ran.err;
  }
}

TEST_F(Commands, EveryCommandRefusesASiteFileThatCannotBeUsed) {
  std::ofstream(file("site.yaml")) << "nonsense: 1\n";
  for (const char* site : {"site.yaml", "none.yaml"}) {
    const Ran ran = run({"info", file("room.bt"), "--site", file(site), "--json"});
    EXPECT_EQ(ran.exit, 2) << site;
    EXPECT_EQ(ran.json()["error"]["code"], "CONFIGURATION") << site;
  }
}

TEST_F(Commands, ACellOfNoSizeIsRefusedBeforeAnybodyIsAsked) {
  std::ofstream(file("site.yaml")) << "lcm_url: memq://\n";
  for (const char* cell : {"0", "-1", "nan"}) {
    const Ran ran = run({"downsample", "robot1", cell, "--out", file("c.csv"), "--site", file("site.yaml")});
    EXPECT_EQ(ran.exit, 2);
    EXPECT_NE(ran.err.find("RES_MISMATCH"), std::string::npos) << ran.err;
  }
}

TEST_F(Commands, AnEditOfNothingIsRefused) {
  std::ofstream(file("voxels.txt")) << "\n";
  EXPECT_NE(run({"edit", "add", "--voxels", file("voxels.txt")}).err.find("EMPTY"), std::string::npos);
}

TEST_F(Commands, ANameThatTheSystemRefusesIsTwo) {
  const Ran ran = run({"--json", "up", "--log", std::string(300, 'a')});
  EXPECT_EQ(ran.exit, 2);
  EXPECT_EQ(ran.json()["error"]["code"], "IO");
}

TEST_F(Commands, AnExceptionIsAFailureLikeOthers) {
  Program program;
  program.add("fall", "", [](const Common&) -> Outcome { throw std::runtime_error("no room"); });
  const char* argv[] = {"concord", "fall"};
  testing::internal::CaptureStderr();
  EXPECT_EQ(program.run(2, argv), 2);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("no room"), std::string::npos);
}

TEST_F(Commands, AVoxelFileIsTakenWholeOrNotAtAll) {
  for (const char* text : {"1 2 3\n4 5\n", "1 2 3\n4 5 6 7\n", "1 2 3\n4 5 x\n", "1 2 3\n4 5 99999999999\n"}) {
    std::ofstream(file("voxels.txt")) << text;
    const Ran ran = run({"edit", "add", "--voxels", file("voxels.txt")});
    EXPECT_EQ(ran.exit, 2) << text;
    EXPECT_NE(ran.err.find("line 2"), std::string::npos) << ran.err;
  }
  std::ofstream out(file("voxels.txt"));
  for (int i = 0; i <= 1'000'000; ++i) out << i << " 0 0\n";
  out.close();
  const Ran ran = run({"edit", "add", "--voxels", file("voxels.txt")});
  EXPECT_EQ(ran.exit, 2);
  EXPECT_NE(ran.err.find("TOO_LARGE"), std::string::npos) << ran.err;
}

TEST_F(Commands, WhatCannotBeMeantIsRefusedBeforeAnyoneIsAsked) {
  const std::vector<std::vector<std::string>> wrong = {
      {"edit", "add"},
      {"edit", "add", "--box", "0 0 0 1 1 1", "--line", "0 0 0 1 1 1"},
      {"edit", "add", "--box", "0 0 0 1 1 1", "--move", "1 0 0"},
      {"edit", "move", "--box", "0 0 0 1 1 1"},
      {"edit", "move", "--box", "0 0 0 1 1 1", "--move", "1 0"},
      {"edit", "add", "--box", "0 0 0 1 1 1", "--thickness", "0.1"},
      {"edit", "add", "--box", "0 0 0 1 1 1", "--id", "a\tb"},
      {"edit", "add", "--box", "0 0 0 1 1 1", "--base-revision", "-1"},
      {"undo", "one\nedit"},
      {"history", "--since", "yesterday"},
      {"history", "--kind", "nonsense"},
      {"history", "--export", "history.xml"},
      {"zone", "add", "Pit", "--no-go"},
      {"zone", "add", "Pit", "--box", "0 0 0 1 1 1"},
      {"zone", "add", "Pit", "--box", "0 0 0 1 1 1", "--no-go", "--allow-contact"},
      {"zone", "add", "Pit/1", "--box", "0 0 0 1 1 1", "--no-go"},
      {"zone", "add", "Pit\u202E", "--box", "0 0 0 1 1 1", "--no-go"},
      {"zone", "add", "..", "--box", "0 0 0 1 1 1", "--no-go"},
      {"zone", "add", " Pit", "--box", "0 0 0 1 1 1", "--no-go"},
      {"zone", "add", std::string(81, 'x'), "--box", "0 0 0 1 1 1", "--no-go"},
      {"zone", "add", "Pit", "--box", "0 0 0 1 1 1", "--no-go", "--author", std::string(1000, 'x')},
      {"zone", "add", "Pit", "--box", "0 0 0 1 1 1", "--no-go", "--id", std::string(81, 'x')},
      {"edit", "add", "--box", "0 0 0 1 1 1", "--author", "a\nb"},
      {"history", "--author", std::string(81, 'x')},
      {"goal", "robot1", "1", "1", "--from", "1"},
      {"goal", "robot 1", "1", "1"},
      {"zone", "delete", "Pit", "--no-go"},
      {"lease", "hold", "mine"},
      {"lease", "free", "mine", "--for", "10"},
      {"lease", "hold", "mine", "--box", "0 0 0 1 1 1", "--for", "nan"},
      {"conflicts", "--most", "0"},
      {"set-weight", "robot1", "0"},
      {"localise", "robot1", "0 0 0 0 0 0 0"},
      {"localise", "robot1", "0 0 0 0 0 0 1", "--at", "noon"},
      {"load", "../map"},
      {"save", "map", "--format", "png"},
      {"save", "map", "--format", "bt,png"},
  };
  for (const auto& arguments : wrong) {
    std::string line;
    for (const std::string& argument : arguments) line += " " + argument;
    EXPECT_EQ(run(arguments).exit, 2) << line;
  }
}

TEST_F(Commands, ASiteFileThatCannotBeUsedIsNamed) {
  std::ofstream(file("site.yaml")) << "nonsense: 1\n";
  const Ran ran = run({"up", "--site", file("site.yaml")});
  EXPECT_EQ(ran.exit, 2);
  EXPECT_NE(ran.err.find("nonsense"), std::string::npos) << ran.err;
}

}  // namespace
}  // namespace concord
