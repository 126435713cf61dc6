#include <string>

#include <gtest/gtest.h>

#include "planner/files/map_server.hpp"
#include "planner/files/movingai.hpp"

namespace concord {
namespace {

const std::string kHead = "type octile\nheight 2\nwidth 3\nmap\n";

TEST(MovingaiMap, IsReadAsItIsMeant) {
  for (const std::string end : {"\n", "\r\n"}) {
    std::string text = kHead + "..@\nGTS\n";
    for (std::size_t at = 0; end.size() == 2 && (at = text.find('\n', at)) != std::string::npos; at += 2) {
      text.replace(at, 1, end);
    }
    const auto grid = read_movingai_map(text);
    ASSERT_TRUE(grid) << grid.error().message;
    EXPECT_EQ(grid->width(), 3);
    EXPECT_EQ(grid->height(), 2);
    for (const Cell open : {Cell{0, 0}, Cell{1, 0}, Cell{0, 1}, Cell{2, 1}}) EXPECT_TRUE(grid->is_open(open));
    for (const Cell blocked : {Cell{2, 0}, Cell{1, 1}, Cell{3, 0}, Cell{0, 2}}) EXPECT_FALSE(grid->is_open(blocked));
  }
}

TEST(MovingaiMap, WhatIsNoneIsRefused) {
  const auto code = [](const std::string& text) { return read_movingai_map(text).error().code; };
  for (const std::string& text :
       {std::string(), std::string("type octile\n"), kHead, kHead + "..@\n", kHead + "..@\nG\n", kHead + "..@\nGTx\n",
        kHead + "..@.\nGTS\n", std::string("type tile\nheight 2\nwidth 3\nmap\n..@\nGTS\n"),
        std::string("type octile\nheight -2\nwidth 3\nmap\n..@\nGTS\n"),
        std::string("type octile\nheight 9\nwidth 99999999999999999999\nmap\n"),
        std::string("height 2\nwidth 3\nmap\n..@\nGTS\n")}) {
    EXPECT_EQ(code(text), Code::kMalformed) << text;
  }
  EXPECT_EQ(code("type octile\nheight 70000\nwidth 3\nmap\n"), Code::kTooLarge);
  EXPECT_EQ(code("type octile\nheight 65000\nwidth 65000\nmap\n"), Code::kTooLarge);
  // A few bytes that claim to be a large map take no memory.
  EXPECT_EQ(code("type octile\nheight 10000\nwidth 10000\nmap\n...\n"), Code::kMalformed);
}

TEST(MovingaiScenario, IsReadAsItIsMeant) {
  const auto queries =
      read_movingai_scenario("version 1\n3\ta.map\t30\t20\t1\t2\t29\t19\t32.5\n\n0 a 30 20 0 0 0 0 0", 30, 20);
  ASSERT_TRUE(queries) << queries.error().message;
  ASSERT_EQ(queries->size(), 2U);
  EXPECT_EQ(queries->at(0).start, (Cell{1, 2}));
  EXPECT_EQ(queries->at(0).goal, (Cell{29, 19}));
  EXPECT_EQ(queries->at(0).optimum, 32.5);
  EXPECT_NEAR(queries->at(0).rounding, 0.06, 1e-5);
  EXPECT_TRUE(read_movingai_scenario("version 1.0\n", 30, 20)->empty());
}

TEST(MovingaiScenario, WhatIsNoneIsRefused) {
  for (const std::string line : {"0 a 30 20 1 2 3", "0 a 30 20 1 2 3 4 nan", "0 a 30 20 1 2 3 4 inf",
                                 "0 a 30 20 1 2 3 4 -1", "0 a 31 20 1 2 3 4 5", "0 a 30 20 30 2 3 4 5",
                                 "0 a 30 20 1 2 3 -4 5", "0 a 30 20 1 2 3 99999999999 5", "words"}) {
    EXPECT_EQ(read_movingai_scenario("version 1\n" + line, 30, 20).error().code, Code::kMalformed) << line;
  }
  EXPECT_FALSE(read_movingai_scenario("", 30, 20));
  EXPECT_FALSE(read_movingai_scenario("version 2\n", 30, 20));
}

const std::string kYaml =
    "image: a.pgm\nresolution: 0.05\norigin: [-1.5, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

TEST(MapServer, IsReadAsItIsMeant) {
  const auto info = read_map_server_yaml(kYaml);
  ASSERT_TRUE(info) << info.error().message;
  EXPECT_EQ(info->image, "a.pgm");
  EXPECT_EQ(info->origin, Eigen::Vector2d(-1.5, 2));
  const std::string pgm = "P5\n# made by hand\n3 2\n255\n" + std::string("\xfe\x00\xcd\x00\xfe\xfe", 6);
  const auto cells = read_map_server_pgm(*info, {reinterpret_cast<const std::uint8_t*>(pgm.data()), pgm.size()});
  ASSERT_TRUE(cells) << cells.error().message;
  // The first row of the picture is the upper one.
  EXPECT_TRUE(is_free(cells->at(VoxelIndex{0, 1, 0})));
  EXPECT_TRUE(is_occupied(cells->at(VoxelIndex{1, 1, 0})));
  EXPECT_FALSE(is_known(cells->at(VoxelIndex{2, 1, 0})));
  EXPECT_TRUE(is_occupied(cells->at(VoxelIndex{0, 0, 0})));
  EXPECT_TRUE(is_free(cells->at(VoxelIndex{2, 0, 0})));
  EXPECT_FALSE(is_known(cells->at(VoxelIndex{3, 0, 0})));
}

TEST(MapServer, WhatIsNoneIsRefused) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kYaml;
    return read_map_server_yaml(text.replace(text.find(from), from.size(), to)).error().code;
  };
  EXPECT_EQ(with("0.05", "0"), Code::kBadResolution);
  EXPECT_EQ(with("0.05", ".nan"), Code::kBadResolution);
  EXPECT_EQ(with("-1.5", ".inf"), Code::kNotFinite);
  EXPECT_EQ(with(", 0]", ", 0.1]"), Code::kMalformed);
  EXPECT_EQ(with("a.pgm", "../a.pgm"), Code::kMalformed);
  EXPECT_EQ(with("negate", "mode: raw\nnegate"), Code::kMalformed);
  EXPECT_EQ(with("resolution", "resolutoin"), Code::kMalformed);
  EXPECT_FALSE(read_map_server_yaml(std::string(5000, '[')));
  EXPECT_FALSE(read_map_server_yaml(std::string(100'000, ' ')));
  const auto pgm = [](const std::string& text) {
    return read_map_server_pgm({}, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}).error().code;
  };
  for (const std::string text :
       {"", "P2\n1 1\n255\n0", "P5\n2 2\n255\nabc", "P5\n0 2\n255\n", "P5\n2 2\n65535\n12345678", "P5\n2"}) {
    EXPECT_EQ(pgm(text), Code::kMalformed) << text;
  }
  EXPECT_EQ(pgm("P5\n90000 90000\n255\n"), Code::kTooLarge);
}

}  // namespace
}  // namespace concord
