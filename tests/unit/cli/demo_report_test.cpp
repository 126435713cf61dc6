#include "cli/demo_report.hpp"

#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace concord {
namespace {

class DemoReportTest : public testing::Test {
 protected:
  void SetUp() override {
    VoxelMask all;
    all.fill(~std::uint64_t{0});
    map.set({0, 0, 0}, Brick::uniform(all, kOccupied));
    report.map = &map;
    report.conflicts = &conflicts;
    AgentState state;
    state.id = "a";
    state.known = 512;
    report.agents.push_back({state, &map, 1000});
    state.id = "b";
    state.known = 100;
    report.agents.push_back({state, &map, 234});
  }

  BrickMap map, conflicts;
  DemoReport report;
};

TEST_F(DemoReportTest, WhatWasNotAskedOrHasNoTruthIsNull) {
  const nlohmann::json json = to_json(report);
  for (const char* key : {"features", "edit", "path_before", "path_after", "replanned"}) {
    EXPECT_TRUE(json.at(key).is_null()) << key;
  }
  EXPECT_TRUE(json["map"].at("precision").is_null());
  EXPECT_TRUE(json["map"].at("recall").is_null());
  EXPECT_TRUE(json["mapping_seconds"].at("one_agent").is_null());
}

TEST_F(DemoReportTest, CountsVoxelsAndBytes) {
  const nlohmann::json json = to_json(report);
  EXPECT_EQ(json["agents"][0]["voxels"], 512);
  EXPECT_EQ(json["agents"][1]["voxels"], 100);
  EXPECT_EQ(json["bytes_sent"], 1234);
  EXPECT_EQ(json["map"]["occupied"], 512);
}

TEST_F(DemoReportTest, LostCloudsAreNamedAndTheReportIsNotComplete) {
  EXPECT_EQ(to_json(report)["complete"], true);
  report.agents[1].clouds_lost = 7;
  const nlohmann::json json = to_json(report);
  EXPECT_EQ(json["complete"], false);
  EXPECT_EQ(json["agents"][0]["clouds_lost"], 0);
  EXPECT_EQ(json["agents"][1]["clouds_lost"], 7);
  report.agents[1].clouds_lost = 0;
  report.streams_whole = false;
  EXPECT_EQ(to_json(report)["complete"], false);
}

TEST_F(DemoReportTest, ThePageLinksAllThatIsThere) {
  const std::string html = to_html(report);
  for (const char* file : {"overview.png", "map.bt", "report.json", "demo.lcm"}) {
    EXPECT_NE(html.find("href=\"" + std::string(file) + "\""), std::string::npos) << file;
  }
}

TEST_F(DemoReportTest, WhatEachShowsAloneStandsBesideWhatAllShow) {
  report.merged = MapScore{0.9, 0.8, {}};
  report.agents[0].recall = 0.5;
  const auto numbers = to_overview(report).numbers;
  const auto shows = [&](const std::string& what, const std::string& value) {
    return std::ranges::find(numbers, std::pair(what, value)) != numbers.end();
  };
  EXPECT_TRUE(shows("true surface shown (recall)", "80.0 %"));
  EXPECT_TRUE(shows("by a alone", "50.0 %"));
  EXPECT_TRUE(std::ranges::none_of(numbers, [](const auto& number) { return number.first == "by b alone"; }));
  EXPECT_EQ(to_json(report)["agents"][0]["recall"], 0.5);
  EXPECT_TRUE(to_json(report)["agents"][1]["recall"].is_null());
}

/// A logger cannot ask again: the page must not promise that all is there.
TEST_F(DemoReportTest, ThePageDoesNotPromiseAWholeLog) {
  EXPECT_EQ(to_html(report).find("Everything"), std::string::npos);
  EXPECT_NE(to_html(report).find("missed"), std::string::npos);
}

TEST_F(DemoReportTest, ThePictureIsToldWhyThereIsNoPath) {
  Path none;
  none.status = "START_CLEARANCE";
  none.message = "the robot does not fit";
  report.path_before = none;
  EXPECT_EQ(to_overview(report).before->message, "the robot does not fit");
}

TEST_F(DemoReportTest, ScoresTheMapAsItEnds) {
  report.robot = MapScore{0.9, 0.3, {{"glass", 0.0, false}}};
  report.merged = MapScore{0.9, 0.8, {{"glass", 0.1, false}}};
  EXPECT_EQ(to_json(report)["map"]["recall"], 0.8);
  report.edited = MapScore{0.95, 0.85, {{"glass", 1.0, true}}};
  const nlohmann::json json = to_json(report);
  EXPECT_EQ(json["map"]["recall"], 0.85);
  EXPECT_EQ(json["features"]["glass"], (nlohmann::json{{"robot", 0.0}, {"merged", 0.1}, {"edited", 1.0}}));
}

TEST_F(DemoReportTest, WhatOneAgentNeverMappedIsNull) {
  report.all_agents_seconds = 40.0;
  const nlohmann::json seconds = to_json(report)["mapping_seconds"];
  EXPECT_EQ(seconds["all_agents"], 40.0);
  EXPECT_TRUE(seconds["one_agent"].is_null());
}

TEST_F(DemoReportTest, ThePageShowsPathsAndHoldsNoForeignMarkup) {
  report.agents[0].state.kind = "<script>";
  Path none;
  none.status = "NO_VALID_PATH";
  none.message = "walls & more";
  report.path_after = none;
  const std::string html = to_html(report);
  EXPECT_EQ(html.find("<script>"), std::string::npos);
  EXPECT_NE(html.find("&lt;script&gt;"), std::string::npos);
  EXPECT_NE(html.find("NO_VALID_PATH"), std::string::npos);
  EXPECT_NE(html.find("walls &amp; more"), std::string::npos);
}

}  // namespace
}  // namespace concord
