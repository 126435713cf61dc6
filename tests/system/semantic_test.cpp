#include <filesystem>
#include <fstream>
#include <memory>
#include <random>

#include <nlohmann/json.hpp>

#include "bus/messages_detection.hpp"
#include "noise.hpp"
#include "semantic/labels/semantic_cloud.hpp"
#include "stack_fixture.hpp"
#include "store/whole_file.hpp"

// Labels, assets and things through the real processes, which are killed between two steps and within them.

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
  void forget(const std::string& process) {
    stack_->kill(process);
    for (const char* part : {".db", ".db-wal", ".db-shm"}) {
      std::filesystem::remove(stack_->folder() / "state" / (process + part));
    }
    stack_->start(process);
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

  forget("semantic");
  const auto loaded = concord("load hall");
  EXPECT_TRUE(loaded.contains("semantic")) << loaded;
  EXPECT_TRUE(shows(labels));
  concord("label undo l2");  // of before it was saved
  EXPECT_TRUE(happens([&] { return concord("labels")["instances"].size() == 1; }));
}

TEST_F(SemanticSystemTest, labels_go_to_a_file_and_come_back_to_the_byte) {
  ASSERT_NO_FATAL_FAILURE(place_a_robot());
  concord("label add shelf" + kBox);
  concord("label add door --box \"0 0 0 0.2 0.2 0.2\"");
  concord("label add door --box \"0.5 0.5 0 0.7 0.7 0.2\"");
  concord("label reassign door 2 --as shelf");
  const auto file = [&](const std::string& name) { return (stack_->folder() / name).string(); };
  const auto bytes = [&](const std::string& name) {
    std::ifstream in(file(name), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const auto saved = concord("labels --out " + file("before.pcd"));
  EXPECT_GT(saved["labelled"], 0);
  forget("semantic");
  EXPECT_EQ(concord("labels --load " + file("before.pcd"))["instances"], 3);
  concord("labels --out " + file("after.pcd"));
  EXPECT_EQ(bytes("before.pcd"), bytes("after.pcd"));
  concord("labels --out " + file("before.ply"));

  forget("semantic");
  concord("label add desk --box \"0.5 0.5 0 0.7 0.7 0.2\"");
  const auto labels = concord("labels");
  EXPECT_EQ(stack_->start_concord(*person_, {"labels", "--load", file("before.ply")}).wait(), 3) << "class 1 is desk";
  EXPECT_EQ(concord("labels"), labels) << "nothing of it was labelled";
}

TEST_F(SemanticSystemTest, one_touch_labels_an_object) {
  ASSERT_NO_FATAL_FAILURE(place_a_robot());
  concord("edit add --box \"9 9 0 9.8 9.8 0.7\"");
  ASSERT_TRUE(happens([&] { return is_occupied(map_->map().at({190, 190, 5})); }));
  const auto touched = concord("label add table --seed \"9.4 9.4 0.4\"");
  EXPECT_GT(touched["instance"]["voxels"], 500) << touched;
  EXPECT_EQ(stack_->start_concord(*person_, {"label", "add", "table", "--seed", "30 30 30"}).wait(), 3);
}

TEST_F(SemanticSystemTest, of_a_file_of_labels_whose_last_is_refused_none_stays) {
  ASSERT_NO_FATAL_FAILURE(place_a_robot());
  concord("label add door --box \"0 0 0 0.2 0.2 0.2\"");
  concord("label add door --box \"0.5 0.5 0 0.7 0.7 0.2\"");
  const std::string file = (stack_->folder() / "doors.pcd").string();
  concord("labels --out " + file);
  SemanticCloud cloud = read_pcd(read_whole_file(file, 10'000'000).value()).value();
  for (SemanticPoint& point : cloud.points) {
    if (point.instance == 2) point.instance = (1U << 30) + 5;  // nobody may ask for that one
  }
  ASSERT_TRUE(write_whole_file(file, write_pcd(cloud)));
  forget("semantic");
  EXPECT_EQ(stack_->start_concord(*person_, {"labels", "--load", file}).wait(), 3);
  EXPECT_TRUE(concord("labels")["instances"].empty()) << concord("labels");
  EXPECT_EQ(concord("labels --classes")["instances"].size(), 1U) << "the first was labelled before it was taken back";
}

TEST_F(SemanticSystemTest, a_map_whose_labels_are_refused_is_not_loaded_at_all) {
  ASSERT_NO_FATAL_FAILURE(place_a_robot());
  concord("label add shelf" + kBox + " --id same");
  concord("save hall --format concord");
  concord("remove robot1");
  ASSERT_TRUE(happens([&] { return agents_.empty(); }));
  forget("semantic");
  forget("merge");
  concord("edit add --box \"5 5 0 5.5 5.5 0.5\"");
  concord("label add table --box \"5 5 0 5.5 5.5 0.5\" --id same");
  EXPECT_EQ(stack_->start_concord(*person_, {"load", "hall"}).wait(), 3);
  EXPECT_TRUE(concord("agents")["agents"].empty()) << concord("agents");
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

/// Each request is asked by the client again and again until it is answered, while what does it is killed at a moment
/// that nobody chose.
class SemanticKillsTest : public SemanticSystemTest {
 protected:
  void ask_and_kill(const std::string& victim, const std::vector<std::string>& arguments) {
    std::vector<std::string> all{"--json", "--timeout", "60"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    Process asker = stack_->start_concord(*person_, all);
    const std::int64_t until = ear_->bus().now() + std::uniform_int_distribution<std::int64_t>(0, 120'000)(random_);
    while (ear_->bus().now() < until) ear_->bus().spin_once(5);
    restart(victim);
    EXPECT_EQ(asker.wait(), 0) << arguments[0] << " " << arguments[1] << ", " << victim << " killed";
  }
  /// How many of each class there are, whole.
  [[nodiscard]] std::map<std::string, int> counted() const {
    std::map<std::string, int> out;
    const nlohmann::json labels = concord("labels");
    for (const auto& one : labels["instances"]) {
      if (one["voxels"] == 21 * 21 * 21) ++out[one["class"]];
    }
    return out;
  }
  [[nodiscard]] bool is_at(double x, double y) const {
    const std::string place = std::to_string(x + 0.5) + " " + std::to_string(y + 0.5) + " 0.5";
    return concord("labels --at \"" + place + "\"")["instances"].size() == 1;
  }
  static std::string at(double x, double y) { return std::to_string(x) + " " + std::to_string(y) + " 0 0 0 0 1"; }

  std::mt19937 random_{7};
};

TEST_F(SemanticKillsTest, assets_are_each_in_one_place_whoever_is_killed_meanwhile) {
  ASSERT_NO_FATAL_FAILURE(place_a_robot());
  const auto victim = [](int i) { return std::string(i % 2 == 0 ? "semantic" : "merge"); };
  for (int i = 0; i < 4; ++i) {
    ask_and_kill(victim(i),
                 {"asset", "inject", "crate", "--transform", at(3 + 2 * i, 5), "--id", "c" + std::to_string(i)});
  }
  EXPECT_TRUE(happens([&] { return counted()["box"] == 4; })) << concord("labels");
  for (int i = 0; i < 4; ++i) {
    const std::string n = std::to_string(i);
    ask_and_kill(victim(i), {"asset", "move", "c" + n, "--transform", at(3 + 2 * i, 9), "--id", "m" + n});
  }
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(happens([&] { return is_at(3 + 2 * i, 9) && !is_at(3 + 2 * i, 5); })) << i;
  }
  EXPECT_EQ(counted()["box"], 4);
  ask_and_kill("semantic", {"asset", "delete", "c0", "--id", "d0"});
  ask_and_kill("merge", {"asset", "delete", "box", "2", "--id", "d1"});
  ask_and_kill("semantic", {"label", "delete", "box", "3", "--id", "d3"});
  EXPECT_TRUE(happens([&] { return counted()["box"] == 1 && is_at(9, 9); })) << concord("labels");
  EXPECT_EQ(concord("labels --at \"9.5 9.5 0.5\"")["instances"][0]["asset"], "crate");
  ask_and_kill("semantic", {"label", "take-off", "box"});
  ask_and_kill("semantic", {"label", "rename", "box", "--as", "crate"});  // of which nothing shows
  EXPECT_EQ(concord("labels --classes")["instances"][0]["class"], "crate");
}

TEST_F(SemanticKillsTest, a_thing_is_injected_once_whoever_is_killed_meanwhile) {
  ASSERT_NO_FATAL_FAILURE(place_a_robot());
  for (int i = 0; i < 3; ++i) {
    Transform T = Transform::Identity();
    T.translation() = Eigen::Vector3d(3 + 3 * i, 5, 0);
    const auto see = [&] {
      static int sightings = 0;
      const Detection seen{"s" + std::to_string(++sightings), "hmd", "crate", "", 0.9, T, {}, ear_->bus().now()};
      ear_->bus().publish("in/detection", encode(seen));
    };
    nlohmann::json things;
    ASSERT_TRUE(happens([&] {
      see();
      things = concord("things")["things"];
      return things.size() == static_cast<std::size_t>(i) + 1 && things.back()["injection"] == "";
    })) << things;
    ask_and_kill("merge", {"things", "confirm", std::to_string(things.back()["thing"].get<int>()), "--id",
                           "k" + std::to_string(i)});
  }
  EXPECT_TRUE(happens([&] { return counted()["box"] == 3; })) << concord("labels");
}

TEST_F(SemanticKillsTest, a_map_is_saved_with_its_labels_and_loaded_whoever_is_killed_meanwhile) {
  ASSERT_NO_FATAL_FAILURE(place_a_robot());
  concord("asset inject crate --transform \"" + at(3, 5) + "\" --id c1");
  ask_and_kill("semantic", {"label", "add", "shelf", "--box", "0.01 0.01 0.01 0.79 0.79 0.79", "--id", "l1"});
  ask_and_kill("merge", {"label", "rename", "shelf", "--as", "rack", "--id", "l2"});
  const auto labels = concord("labels");
  ASSERT_EQ(labels["instances"].size(), 2U) << labels;
  ask_and_kill("semantic", {"save", "hall", "--format", "concord"});
  concord("remove robot1");
  ASSERT_TRUE(happens([&] { return agents_.empty(); }));
  stack_->kill("semantic");
  for (const char* part : {".db", ".db-wal", ".db-shm"}) {
    std::filesystem::remove(stack_->folder() / "state" / (std::string("semantic") + part));
  }
  stack_->start("semantic");
  ask_and_kill("semantic", {"load", "hall"});
  EXPECT_TRUE(shows(labels)) << concord("labels");
}

}  // namespace
}  // namespace concord::test
