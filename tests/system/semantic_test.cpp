#include <filesystem>
#include <fstream>
#include <memory>

#include <nlohmann/json.hpp>

#include "noise.hpp"
#include "stack_fixture.hpp"

// Labels, assets and things through the real processes, which are killed between any two steps.

namespace concord::test {
namespace {

constexpr double kResolution = 0.05;
const std::string kBox = " --box \"0.01 0.01 0.01 0.79 0.79 0.79\"";

class SemanticSystemTest : public StackFixture {
 protected:
  void SetUp() override {
    StackFixture::SetUp();
    if (IsSkipped()) return;
    const auto folder = stack_->folder() / "state/assets";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "assets.yaml") << "crate: {file: crate.obj, class: box}\n";
    std::ofstream out(folder / "crate.obj");
    for (int i = 0; i < 8; ++i) out << "v " << (i & 1) << " " << (i >> 1 & 1) << " " << (i >> 2) << "\n";
    out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    out.close();
    stack_->start_all();
    map_ = std::make_unique<StreamCopy>(*person_, "out/map", kResolution);
    agent_ = std::make_unique<StreamCopy>(*person_, "out/agent/robot1", kResolution);
  }

  [[nodiscard]] bool happens(const std::function<bool()>& event) {
    return eventually({&map_->bus(), &agent_->bus(), &ear_->bus()}, event);
  }
  nlohmann::json concord(const std::string& arguments) const {
    return nlohmann::json::parse(stack_->concord(*person_, "--json --timeout 20 " + arguments));
  }
  void restart(const std::string& process) {
    stack_->kill(process);
    stack_->start(process);
  }
  void place_a_robot() {
    StreamSource robot(network().add("robot1"), "in/robot1", kResolution, noisy_map(12, 1));
    ASSERT_TRUE(eventually({&robot.bus(), &agent_->bus(), &ear_->bus()},
                           [&] { return agent_->synced() && agent_->map() == robot.map() && agents_.size() == 1; }));
    concord("set-transform robot1 \"0 0 0 0 0 0 1\"");
    ASSERT_TRUE(happens([&] { return map_->synced() && map_->map().brick_count() >= 12; }));
  }
  /// What is labelled, whole: asked until all that was labelled shows again.
  [[nodiscard]] bool shows(const nlohmann::json& labels) {
    return happens([&] { return concord("labels") == labels; });
  }

  std::unique_ptr<StreamCopy> map_, agent_;
};

TEST_F(SemanticSystemTest, labels_outlive_kills_and_come_back_with_a_saved_map) {
  ASSERT_NO_FATAL_FAILURE(place_a_robot());
  concord("label add shelf" + kBox);
  concord("label add door --box \"0 0 0 0.2 0.2 0.2\" --id l2");
  const auto labels = concord("labels");
  ASSERT_EQ(labels["instances"].size(), 2U) << labels;
  restart("semantic");
  EXPECT_TRUE(shows(labels));
  concord("save hall --format concord");
  concord("remove robot1");
  ASSERT_TRUE(happens([&] { return agents_.empty(); }));

  stack_->kill("semantic");
  for (const char* part : {".db", ".db-wal", ".db-shm"}) {
    std::filesystem::remove(stack_->folder() / "state" / (std::string("semantic") + part));
  }
  stack_->start("semantic");
  const auto loaded = concord("load hall");
  EXPECT_TRUE(loaded.contains("semantic")) << loaded;
  EXPECT_TRUE(shows(labels));
  concord("label undo l2");  // of before it was saved
  EXPECT_TRUE(happens([&] { return concord("labels")["instances"].size() == 1; }));
}

TEST_F(SemanticSystemTest, an_asset_is_injected_moved_and_taken_out_across_kills) {
  ASSERT_NO_FATAL_FAILURE(place_a_robot());
  concord("asset inject crate --transform \"3 3 0 0 0 0 1\" --id c1");
  restart("merge");
  restart("semantic");
  concord("asset move c1 --transform \"6 3 0 0 0 0 1\" --id m1");
  restart("semantic");
  const auto box_at = [&](const std::string& place) { return concord("labels --at \"" + place + "\"")["instances"]; };
  EXPECT_TRUE(happens([&] { return box_at("6.5 3.5 0.5").size() == 1 && box_at("3.5 3.5 0.5").empty(); }));
  EXPECT_EQ(box_at("6.5 3.5 0.5")[0]["instance"], 1);
  concord("asset delete c1");
  EXPECT_TRUE(happens([&] { return box_at("6.5 3.5 0.5").empty() && box_at("3.5 3.5 0.5").empty(); }));
}

}  // namespace
}  // namespace concord::test
