#include <cinttypes>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "stack.hpp"
#include "station.hpp"
#include "system_test.hpp"

// Two real maps, each sent from a host of its own, against `concord merge` on the files: the same map, to the byte.
// What `concord merge` gives is held to an oracle without bricks in tests/unit/core_compose.

namespace concord::test {
namespace {

struct Pair {
  const char* name;
  const char* a;
  const char* b;
  double resolution;
  const char* transform;
  const char* policy;
};

void PrintTo(const Pair& pair, std::ostream* out) { *out << pair.name; }

constexpr Pair kPairs[] = {
    {"warehouse_mean", "slam_xr_maps/test4.bt", "slam_xr_maps/test5.bt", 0.05,
     "1.234 -0.777 0.031 0.02 -0.03 0.1 0.994334", "mean"},
    {"building_table", "balm_building/session_A_0.1m.bt", "balm_building/session_B_0.1m.bt", 0.1,
     "-2.5 0.41 0.07 0.01 0.02 -0.38 0.924712", "table"},
};

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016" PRIx64, value);
  return text;
}

const std::string kUnmoved = "0 0 0 0 0 0 1";
/// 40 degrees about the vertical: a robot that began facing elsewhere.
const std::string kTurnedAway = "3 -2 0 0 0 0.342020 0.939693";

class RealMapsSystemTest : public SystemTest, public ::testing::WithParamInterface<Pair> {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    if (IsSkipped()) return;
    const char* given = std::getenv("CONCORD_DATA");
    const std::filesystem::path data = given != nullptr ? given : CONCORD_SHARED_DATA;
    a_ = data / GetParam().a;
    b_ = data / GetParam().b;
    if (!std::filesystem::exists(a_)) GTEST_SKIP() << a_ << " is not there; set CONCORD_DATA";
    stack_ = std::make_unique<Stack>(network(), "resolution: " + std::to_string(GetParam().resolution) +
                                                    "\nmerge: {policy: " + GetParam().policy + "}\n");
    stack_->start_all();
    person_ = &network().add("person");
    map_ = std::make_unique<StreamCopy>(*person_, "out/map", GetParam().resolution);
    conflicts_ = std::make_unique<StreamCopy>(*person_, "out/conflicts", GetParam().resolution);
  }

  void publish_both() {
    Process first =
        stack_->start_concord(network().add("robot1"), {"--timeout", "100", "publish", a_, "--agent", "robot1"});
    Process second =
        stack_->start_concord(network().add("robot2"), {"--timeout", "100", "publish", b_, "--agent", "robot2"});
    ASSERT_EQ(first.wait(), 0) << stack_->logs();
    ASSERT_EQ(second.wait(), 0) << stack_->logs();
  }
  nlohmann::json ask(const std::string& what) { return nlohmann::json::parse(stack_->concord(*person_, what)); }
  void place(const std::string& agent, const std::string& T) {
    stack_->concord(*person_, "set-transform " + agent + " '" + T + "'");
  }
  /// What the map is when robot1 lies unmoved and robot2 at T, by the files alone.
  nlohmann::json fresh_merge(const std::string& T) {
    return ask("--json merge " + a_ + " " + b_ + " --transform '" + T + "' --policy " + GetParam().policy);
  }
  void expect_map(const nlohmann::json& expected) {
    const std::size_t known = expected["occupied"].get<std::size_t>() + expected["free"].get<std::size_t>();
    const std::size_t conflicting = expected["conflicting"].get<std::size_t>();
    EXPECT_TRUE(eventually({&map_->bus(), &conflicts_->bus()},
                           [&] {
                             return map_->synced() && conflicts_->synced() && map_->map().known_count() == known &&
                                    conflicts_->map().known_count() == conflicting;
                           }))
        << map_->map().known_count() << " of " << known << " voxels, " << conflicts_->map().known_count() << " of "
        << conflicting << " conflicts\n"
        << stack_->logs();
    EXPECT_EQ(hex(digest(map_->map())), expected["digest"]);
  }

  std::string a_, b_;
  std::unique_ptr<Stack> stack_;
  const Host* person_ = nullptr;
  std::unique_ptr<StreamCopy> map_, conflicts_;
};

TEST_P(RealMapsSystemTest, arrive_whole_and_are_merged_as_files_are) {
  ASSERT_NO_FATAL_FAILURE(publish_both());
  place("robot1", kUnmoved);
  place("robot2", GetParam().transform);
  expect_map(fresh_merge(GetParam().transform));
}

TEST_P(RealMapsSystemTest, placed_wrongly_and_then_rightly_leave_no_ghost) {
  ASSERT_NO_FATAL_FAILURE(publish_both());
  place("robot1", kUnmoved);
  place("robot2", kTurnedAway);
  const nlohmann::json wrong = fresh_merge(kTurnedAway);
  expect_map(wrong);
  const nlohmann::json listed = ask("--json conflicts");
  EXPECT_EQ(listed["voxels_in_all"], wrong["conflicting"]);
  EXPECT_FALSE(listed["regions"].empty());

  place("robot2", GetParam().transform);
  const nlohmann::json right = fresh_merge(GetParam().transform);
  ASSERT_NE(right["digest"], wrong["digest"]);
  expect_map(right);
  EXPECT_EQ(ask("--json conflicts")["voxels_in_all"], right["conflicting"]);
}

INSTANTIATE_TEST_SUITE_P(Pairs, RealMapsSystemTest, ::testing::ValuesIn(kPairs),
                         [](const auto& pair) { return std::string(pair.param.name); });

}  // namespace
}  // namespace concord::test
