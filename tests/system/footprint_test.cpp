#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stack_fixture.hpp"

// A robot that is not round, on the real processes: its path, an edit on it, the path aside, and cancel.

namespace concord::test {
namespace {

/// Two rooms, 6.4 m x 6.4 m together, with two doors of 1.6 m; free up to 1.6 m.
BrickMap two_rooms() {
  BrickMap map;
  for (int bx = 0; bx < 16; ++bx) {
    for (int by = 0; by < 16; ++by) {
      for (int bz = 0; bz < 5; ++bz) {
        DenseBrick dense;
        for (int i = 0; i < 512; ++i) {
          const int x = bx * 8 + (i & 7), y = by * 8 + (i >> 3 & 7);
          const bool is_door = (y >= 8 && y < 40) || (y >= 88 && y < 120);
          const bool is_wall = x == 0 || y == 0 || x == 127 || y == 127 || ((x == 64 || x == 65) && !is_door);
          dense[static_cast<std::size_t>(i)] = is_wall ? kOccupied : kFree;
        }
        map.set({bx, by, bz}, Brick::from_dense(dense));
      }
    }
  }
  return map;
}

class FootprintSystemTest : public StackFixture {
 protected:
  [[nodiscard]] std::string settings() const override {
    return "agents: {truck1: {footprint: \"1.0x0.6\", turn_radius: 0.4}}\n";
  }
  void SetUp() override {
    StackFixture::SetUp();
    if (IsSkipped()) return;
    person_->inside([this] {
      listen<Path>(ear_->bus(), ear_->counters(), "test", "out/path/truck1",
                   [this](const std::string&, Path path) { paths_.push_back(std::move(path)); });
    });
    robot_ = std::make_unique<StreamSource>(network().add("scanner"), "in/scanner", 0.05, two_rooms());
  }
  [[nodiscard]] bool happens(const std::function<bool()>& event) const {
    return eventually({&ear_->bus(), &robot_->bus()}, event);
  }
  [[nodiscard]] nlohmann::json ask(const std::string& arguments) const {
    return nlohmann::json::parse(stack_->concord(*person_, "--json " + arguments));
  }
  [[nodiscard]] bool is_known() {
    return happens([this] { return !agents_.empty() && agents_.front().id == "scanner" && agents_.front().synced; });
  }

  std::vector<Path> paths_;
  std::unique_ptr<StreamSource> robot_;
};

TEST_F(FootprintSystemTest, an_edit_turns_a_truck_aside_and_cancel_ends_its_path) {
  stack_->start_all();
  ASSERT_TRUE(is_known());
  stack_->concord(*person_, "set-transform scanner \"0 0 0 0 0 0 1\"");
  const std::string goal = "goal truck1 5.5 1.2 --from \"1.2 1.2\"";
  // The planner may be a moment behind the map.
  ASSERT_TRUE(happens([&] {
    try {
      return ask(goal)["status"] == "OK";
    } catch (const std::runtime_error&) {
      return false;
    }
  }));
  const auto is_there = [this](const std::string& status) {
    return happens([&] { return !paths_.empty() && paths_.back().status == status; });
  };
  ASSERT_TRUE(is_there("OK"));
  const Path before = paths_.back();
  EXPECT_EQ(before.footprint.size(), 4U);
  EXPECT_LT(before.length, 6);

  stack_->concord(*person_, "edit add --box \"3.0 0.3 0.2 3.2 2.1 1.4\"");
  ASSERT_TRUE(happens([&] { return paths_.back().status == "OK" && paths_.back().plan_number > before.plan_number; }));
  EXPECT_GT(paths_.back().length, before.length + 3) << "by the other door";
  const auto stops = std::find_if(paths_.begin(), paths_.end(), [](const Path& p) { return p.status == "REPLANNING"; });
  EXPECT_NE(stops, paths_.end()) << "the truck was told to stop first";

  stack_->concord(*person_, "cancel truck1");
  EXPECT_TRUE(is_there("CANCELLED"));
  EXPECT_FALSE(paths_.back().active);
}

}  // namespace
}  // namespace concord::test
