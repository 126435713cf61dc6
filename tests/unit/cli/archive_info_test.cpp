#include "cli/archive_info.hpp"

#include <gtest/gtest.h>

namespace concord {
namespace {

MapArchive sample() {
  MapArchive archive;
  archive.resolution = 0.1;
  VoxelMask one{};
  one[0] = 1;
  archive.layers.push_back({{"robot1", "lidar", "start", 5, 3}, {}});
  archive.layers[0].bricks.set({0, 0, 0}, Brick::uniform(one, kOccupied));
  const auto change = [&](std::int64_t revision, ZoneRequest::Op op, const std::string& name) {
    Zone zone;
    zone.name = name;
    zone.volume = Box{{0, 0, 0}, {1, 2, 3}};
    archive.corrections.push_back(
        {revision, "z" + std::to_string(revision), "ann", 0, 0, Correction::ZoneChange{op, zone}});
  };
  change(1, ZoneRequest::Op::kAdd, "Pit");
  change(2, ZoneRequest::Op::kAdd, "Door");
  change(5, ZoneRequest::Op::kDelete, "Pit");
  return archive;
}

TEST(ArchiveInfo, TellsLayersCorrectionsAndTheZonesThatAreLeft) {
  const nlohmann::json json = to_json(sample());
  EXPECT_EQ(json["layers"][0]["agent"], "robot1");
  EXPECT_EQ(json["layers"][0]["occupied"], 1);
  EXPECT_EQ(json["corrections"]["zone-add"], 2);
  EXPECT_EQ(json["corrections"]["zone-delete"], 1);
  EXPECT_EQ(json["revision"], 5);
  ASSERT_EQ(json["zones"].size(), 1U);
  EXPECT_EQ(json["zones"][0]["name"], "Door");
  const std::string words = to_words(sample());
  EXPECT_NE(words.find("3 corrections: 2 zone-add, 1 zone-delete\n"), std::string::npos) << words;
  EXPECT_NE(words.find("Door  no-go  box    0.00..1.00  0.00..2.00  0.00..3.00\n"), std::string::npos) << words;
}

TEST(ArchiveInfo, AnEmptyOneIsSaidToBe) {
  MapArchive archive;
  archive.resolution = 0.1;
  EXPECT_EQ(to_words(archive), "resolution  0.1000 m\nno layers\n0 corrections\nno zones");
}

}  // namespace
}  // namespace concord
