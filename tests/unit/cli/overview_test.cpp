#include "cli/overview.hpp"

#include <png.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "cli/relief.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.1;

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

/// A PNG read back.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;

  explicit Picture(const std::filesystem::path& file) {
    png_image image = {};
    image.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_file(&image, file.c_str()) == 0) return;
    image.format = PNG_FORMAT_RGB;
    rgb.resize(PNG_IMAGE_SIZE(image));
    if (png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr) == 0) return;
    width = static_cast<int>(image.width);
    height = static_cast<int>(image.height);
  }

  [[nodiscard]] std::array<int, 3> at(const Eigen::Vector2d& pixel) const {
    const std::size_t i = (static_cast<std::size_t>(pixel.y()) * width + static_cast<std::size_t>(pixel.x())) * 3;
    return {rgb[i], rgb[i + 1], rgb[i + 2]};
  }
};

class OverviewTest : public testing::Test {
 protected:
  void SetUp() override {
    // A floor of 8 x 4 m; a low wall that only `left` saw at x = 1, one that only `right` saw at x = 6.
    fill(map, {0, 0, 0}, {79, 39, 15}, kFree);
    fill(map, {0, 0, -1}, {79, 39, -1}, kOccupied);
    fill(map, {10, 5, 0}, {13, 35, 9}, kOccupied);
    fill(map, {60, 5, 0}, {63, 35, 9}, kOccupied);
    fill(left, {10, 5, 0}, {13, 35, 9}, kOccupied);
    fill(right, {60, 5, 0}, {63, 35, 9}, kOccupied);
    overview.title = "Test";
    overview.resolution = kResolution;
    overview.cut = 2.0;
    overview.map = &map;
    overview.agents = {{"left", &left, Transform::Identity(), 1000}, {"right", &right, Transform::Identity(), 2000}};
  }
  void TearDown() override { std::filesystem::remove(file); }

  BrickMap map, left, right, conflicts;
  Overview overview;
  std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / ("overview" + std::to_string(getpid()) + ".png");
};

TEST_F(OverviewTest, ShowsEachThingInItsColourAtItsPlace) {
  fill(conflicts, {20, 10, 0}, {23, 13, 9}, kOccupied);
  overview.conflicts = &conflicts;
  for (std::int32_t y = 0; y < 30; ++y) {
    for (std::int32_t z = 0; z < 5; ++z) overview.edit.push_back({40, y, z});
  }
  overview.before = Overview::Route{"OK", {{3, 0.5}, {5.5, 0.5}}, 2.5};
  overview.after = Overview::Route{"OK", {{3, 0.5}, {3, 3.5}, {5.5, 3.5}}, 5.5};
  const auto frame = write_overview(overview, file);
  ASSERT_TRUE(frame) << frame.error().message;
  const Picture picture(file);
  ASSERT_EQ(picture.width, frame->width);
  ASSERT_EQ(picture.height, frame->height);

  const auto [left_r, left_g, left_b] = picture.at(frame->pixel_of({1.25, 2}));
  EXPECT_GT(left_b, left_r + 60) << "the first agent is blue";
  const auto [right_r, right_g, right_b] = picture.at(frame->pixel_of({6.25, 2}));
  EXPECT_GT(right_r, right_b + 60) << "the second agent is orange";
  EXPECT_GT(right_g, right_b + 20);
  const auto [floor_r, floor_g, floor_b] = picture.at(frame->pixel_of({7.5, 1}));
  EXPECT_GT(std::min({floor_r, floor_g, floor_b}), 200) << "the floor is pale";
  const auto [edit_r, edit_g, edit_b] = picture.at(frame->pixel_of({4.05, 2.5}));
  EXPECT_NEAR(edit_r, 128, 3);
  EXPECT_NEAR(edit_g, 15, 3);
  EXPECT_NEAR(edit_b, 51, 3);
  const auto [conflict_r, conflict_g, conflict_b] = picture.at(frame->pixel_of({2.2, 1.2}));
  EXPECT_GT(conflict_r, conflict_b + 60) << "conflicts are amber";
  const auto [after_r, after_g, after_b] = picture.at(frame->pixel_of({3, 2}));
  EXPECT_GT(after_g, after_r + 80) << "the path after the edit is green";
}

TEST_F(OverviewTest, SeesATurnedSubmapWhereItLies) {
  // The agent's frame is the map's turned by a quarter: its x axis lies along the map's y.
  BrickMap turned;
  fill(turned, {5, -14, 0}, {35, -11, 9}, kOccupied);
  Transform T_map_agent = Transform::Identity();
  T_map_agent.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  overview.agents = {{"other", &right, Transform::Identity(), 0}, {"turned", &turned, T_map_agent, 0}};
  Relief relief = look_down(overview);
  EXPECT_EQ(relief.at(11, 20)->claims, 2U);
  EXPECT_EQ(relief.at(61, 20)->claims, 1U);
  EXPECT_EQ(relief.at(40, 20)->claims, 0U);
}

TEST_F(OverviewTest, CutsOffWhatLiesAbove) {
  fill(map, {0, 0, 25}, {79, 39, 25}, kOccupied);  // a ceiling
  Relief relief = look_down(overview);
  EXPECT_NEAR(relief.at(40, 20)->top, 0.0, 1e-6);
  EXPECT_NEAR(relief.at(11, 20)->top, 1.0, 1e-6);
  EXPECT_NEAR(relief.floor, 0.0, 1e-6);
}

TEST_F(OverviewTest, StaysBoundedWhenTheMapHasOutliers) {
  fill(map, {1000000, 0, 0}, {1000000, 0, 0}, kOccupied);
  EXPECT_LT(look_down(overview).width, 200);
  overview.goal = Eigen::Vector2d(100000.0, 0.0);
  EXPECT_LE(look_down(overview).width, 8192);
}

TEST_F(OverviewTest, RefusesAMapWithNothingToDraw) {
  const BrickMap empty;
  overview.map = &empty;
  EXPECT_EQ(write_overview(overview, file).error().code, Code::kEmpty);
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST_F(OverviewTest, RefusesAFolderThatIsNotThere) {
  EXPECT_EQ(write_overview(overview, "/no/such/folder/a.png").error().code, Code::kIo);
}

}  // namespace
}  // namespace concord
