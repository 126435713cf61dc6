#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "noise.hpp"
#include "stack_fixture.hpp"

// A native map through the real ingest and merge: saved, taken apart, loaded.

namespace concord::test {
namespace {

constexpr double kResolution = 0.05;
const std::string kSomewhere = "\"1.03 -2 0.1 0 0 0.6 0.8\"";
const std::string kBox = " --box \"0.01 0.01 2.01 0.99 0.04 2.99\"";

class SavedMapSystemTest : public StackFixture {
 protected:
  void SetUp() override {
    StackFixture::SetUp();
    if (IsSkipped()) return;
    stack_->start_all();
    map_ = std::make_unique<StreamCopy>(*person_, "out/map", kResolution);
    agent_ = std::make_unique<StreamCopy>(*person_, "out/agent/robot1", kResolution);
  }

  [[nodiscard]] bool happens(const std::function<bool()>& event) {
    return eventually({&map_->bus(), &agent_->bus(), &ear_->bus()}, event);
  }
  std::string concord(const std::string& arguments) const { return stack_->concord(*person_, arguments); }

  /// A robot was here and has gone; people placed its map and corrected it, and saved all of it.
  void work_and_save() {
    {
      StreamSource robot(network().add("robot1"), "in/robot1", kResolution, noisy_map(12, 1));
      ASSERT_TRUE(eventually({&robot.bus(), &agent_->bus(), &ear_->bus()},
                             [&] { return agent_->synced() && agent_->map() == robot.map() && agents_.size() == 1; }));
    }
    concord("set-transform robot1 " + kSomewhere);
    concord("edit add" + kBox);
    ASSERT_TRUE(happens([&] { return map_->synced() && map_->map().brick_count() > 12; }));
    concord("--timeout 20 save --format concord,bt hall");
    ASSERT_TRUE(happens([&] { return map_->synced(); }));
    before_ = map_->map();
  }
  void remove_robot() {
    concord("remove robot1");
    ASSERT_TRUE(happens([&] { return agents_.empty() && map_->synced() && !(map_->map() == before_); }));
  }

  std::unique_ptr<StreamCopy> map_, agent_;
  BrickMap before_;
};

TEST_F(SavedMapSystemTest, a_map_that_is_loaded_is_the_one_that_was_saved) {
  ASSERT_NO_FATAL_FAILURE(work_and_save());
  ASSERT_NO_FATAL_FAILURE(remove_robot());
  concord("load hall");
  EXPECT_TRUE(happens([&] { return map_->synced() && map_->map() == before_; })) << "to the byte";
}

TEST_F(SavedMapSystemTest, a_taken_zone_name_leaves_no_agent_and_the_map_is_loaded_once_it_is_free) {
  concord("zone add door --no-go" + kBox);
  ASSERT_NO_FATAL_FAILURE(work_and_save());
  for (const char* process : {"merge", "ingest"}) stack_->kill(process);
  for (const char* process : {"merge", "ingest"}) {
    for (const char* part : {".db", ".db-wal", ".db-shm"}) {
      std::filesystem::remove(stack_->folder() / "state" / (std::string(process) + part));
    }
    stack_->start(process);
  }
  concord("zone add door --no-go" + kBox);
  EXPECT_THROW(concord("load hall --id again"), std::runtime_error);
  EXPECT_EQ(concord("--json agents").find("robot1"), std::string::npos) << concord("--json agents");

  concord("zone delete door");
  concord("load hall --id again");
  EXPECT_TRUE(happens([&] { return map_->synced() && map_->map() == before_; })) << "to the byte";
}

}  // namespace
}  // namespace concord::test
