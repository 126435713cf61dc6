#include <algorithm>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "../unit/align/rooms.hpp"
#include "core/octomap_writer.hpp"
#include "stack_fixture.hpp"
#include "store/whole_file.hpp"

// The real processes: two robots who have each seen most of one room, and one who has been in another.

namespace concord::test {
namespace {

constexpr double kNear = 0.08;  // metres: both are in voxels of 0.05

std::string text_of(const Transform& T) {
  const Eigen::Vector3d p = T.translation();
  const Eigen::Quaterniond q(T.linear());
  std::string out;
  for (const double number : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}) out += std::to_string(number) + " ";
  return out;
}

class AlignSystemTest : public StackFixture {
 protected:
  void SetUp() override {
    StackFixture::SetUp();
    if (IsSkipped()) return;
    stack_->start_all();
    person_->inside([this] {
      listen<AlignResult>(ear_->bus(), ear_->counters(), "test", "out/align",
                          [this](const std::string&, AlignResult result) { said_ = std::move(result); });
    });
  }

  void publish(const std::string& robot, const Points& points) {
    const auto bytes = write_octomap_file(voxels_of(points), kResolution, OctomapFormat::kFull);
    ASSERT_TRUE(bytes);
    const std::string file = (stack_->folder() / (robot + ".ot")).string();
    ASSERT_TRUE(write_whole_file(file, *bytes));
    Process sends = stack_->start_concord(network().add(robot), {"--timeout", "60", "publish", file, "--agent", robot});
    ASSERT_EQ(sends.wait(), 0);
  }
  /// What the client says of an alignment, and its exit code.
  [[nodiscard]] nlohmann::json asked(const std::string& arguments) const {
    return nlohmann::json::parse(stack_->concord(*person_, "--json --timeout 60 align " + arguments));
  }
  [[nodiscard]] int exit_code(std::vector<std::string> arguments) const {
    return stack_->start_concord(*person_, std::move(arguments)).wait();
  }
  /// Whether the agent comes to lie there; nullopt: nowhere.
  [[nodiscard]] bool comes_to_lie(const std::string& robot, const std::optional<Transform>& T_map_robot) {
    return eventually({&ear_->bus()}, [&] {
      const auto found = std::ranges::find(agents_, robot, &AgentState::id);
      if (found == agents_.end() || found->aligned != T_map_robot.has_value()) return false;
      return !T_map_robot || metres_off(found->T_map_agent, *T_map_robot) < kNear;
    });
  }

  AlignResult said_;
};

TEST_F(AlignSystemTest, IsAskedAcceptedUndoneAndWatched) {
  ASSERT_NO_FATAL_FAILURE(publish("robot1", left_part()));
  ASSERT_NO_FATAL_FAILURE(publish("robot2", right_part()));
  ASSERT_NO_FATAL_FAILURE(publish("robot3", other_room()));
  const std::string guess = "--guess '" + text_of(transform(0.5, -0.3, 0.1, 0.2) * kT_left_right) + "'";

  // Nobody is in the map: the first pair founds it.
  EXPECT_EQ(exit_code({"align", "robot2"}), 3);
  const auto first = asked("robot2 robot1 --accept " + guess);
  EXPECT_TRUE(first["accepted"].get<bool>());
  EXPECT_EQ(first["reason"], "ACCEPTED");
  EXPECT_GT(first["overlap"].get<double>(), 0.4);
  EXPECT_GT(first["source"]["revision"].get<int>(), 0);
  EXPECT_TRUE(comes_to_lie("robot1", Transform::Identity()));
  EXPECT_TRUE(comes_to_lie("robot2", kT_left_right));

  // Undone it waits outside; found again by a process that has just begun.
  stack_->concord(*person_, "undo " + first["placement"]["id"].get<std::string>());
  EXPECT_TRUE(comes_to_lie("robot2", std::nullopt));
  stack_->kill("align");
  stack_->start("align");
  const auto again = asked("robot2 --accept " + guess);
  EXPECT_TRUE(again["accepted"].get<bool>());
  EXPECT_TRUE(again["target"].is_null());
  EXPECT_TRUE(comes_to_lie("robot2", kT_left_right));

  // Another room is refused.
  EXPECT_EQ(exit_code({"align", "robot3"}), 3);
  EXPECT_EQ(exit_code({"align", "nobody"}), 3);

  // Somebody puts it a little wrong: people are told, and it stays until they say so.
  const Transform slipped = transform(0.2, -0.15, 0.0, 0.02) * kT_left_right;
  said_ = {};
  stack_->concord(*person_, "set-transform robot2 '" + text_of(slipped) + "'");
  ASSERT_TRUE(eventually({&ear_->bus()}, [&] {
    return said_.author.empty() && said_.open && said_.source.agent == "robot2" && said_.slip > 0.1;
  }));
  EXPECT_TRUE(comes_to_lie("robot2", slipped));
  stack_->concord(*person_, "alignment accept " + said_.id);
  EXPECT_TRUE(comes_to_lie("robot2", kT_left_right));
  stack_->interrupt_all();
}

}  // namespace
}  // namespace concord::test
