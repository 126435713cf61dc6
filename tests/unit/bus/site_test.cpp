#include "bus/site.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace concord::test {
namespace {

class SiteFile : public testing::Test {
 protected:
  void SetUp() override {
    directory_ =
        std::filesystem::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(directory_);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  Site load(const std::string& yaml) {
    std::ofstream(directory_ / "site.yaml") << yaml;
    return load_site(directory_ / "site.yaml");
  }
  /// The refusal, after the file's name.
  std::string refusal(const std::string& yaml) {
    try {
      (void)load(yaml);
    } catch (const ConfigError& e) {
      const std::string what = e.what();
      const std::string prefix = (directory_ / "site.yaml").string() + ": ";
      EXPECT_EQ(what.rfind(prefix, 0), 0U) << what;
      return what.substr(std::min(what.size(), prefix.size()));
    }
    return "accepted";
  }

  std::filesystem::path directory_;
};

const char* const kEveryKey = R"(lcm_url: udpm://239.255.76.68:7668?ttl=1
beyond_host: true
state: kept
resolution: 0.1
agents:
  robot1: {kind: lidar, weight: 7, radius: 0.4}
  hmd: {kind: headset}
  unlisted: {kind: guest, weight: 2, radius: 0.2}
classes:
  fork lift: {margin: 0.5, cost: 4, cost_margin: 2}
stream: {bytes_per_second: 1000000}
ingest: {max_agents: 3, max_known_voxels: 1000}
merge: {policy: table}
planner: {zmin: 0.2, zmax: 1.5, free_share: 0.25}
)";

TEST_F(SiteFile, every_key_is_read) {
  const Site site = load(kEveryKey);
  EXPECT_EQ(site.lcm_url, "udpm://239.255.76.68:7668?ttl=1");
  EXPECT_TRUE(site.beyond_host);
  EXPECT_EQ(site.state, directory_ / "kept");
  EXPECT_EQ(site.resolution, 0.1);
  EXPECT_EQ(site.agent("robot1").kind, "lidar");
  EXPECT_EQ(site.agent("robot1").weight, 7);
  EXPECT_EQ(site.agent("robot1").radius, 0.4);
  EXPECT_EQ(site.agent("hmd").kind, "headset");
  EXPECT_EQ(site.agent("hmd").weight, 2) << "what an agent leaves out is as for unlisted ones";
  EXPECT_EQ(site.agent("stranger").kind, "guest");
  EXPECT_EQ(site.classes.at("fork lift").margin, 0.5);
  EXPECT_EQ(site.classes.at("fork lift").cost, 4);
  EXPECT_EQ(site.classes.at("fork lift").cost_margin, 2.0);
  EXPECT_EQ(site.stream.bytes_per_second, 1e6);
  EXPECT_EQ(site.ingest.max_agents, 3);
  EXPECT_EQ(site.ingest.max_known_voxels, 1000);
  EXPECT_EQ(site.merge.policy, Policy::kTable);
  EXPECT_EQ(site.planner.zmin, 0.2);
  EXPECT_EQ(site.planner.zmax, 1.5);
  EXPECT_EQ(site.planner.free_share, 0.25);
}

TEST_F(SiteFile, terms_of_classes_are_within_bounds_and_whole) {
  const std::string both = "line 1: classes.glass needs both cost and cost_margin, the latter above margin";
  EXPECT_EQ(refusal("classes: {glass: {cost: 4}}"), both);
  EXPECT_EQ(refusal("classes: {glass: {cost_margin: 1}}"), both);
  EXPECT_EQ(refusal("classes: {glass: {margin: 1, cost: 4, cost_margin: 1}}"), both);
  EXPECT_EQ(refusal("classes: {glass: {margin: .nan}}"), "line 1: classes.glass.margin must lie between 0 and 10");
  EXPECT_EQ(refusal("classes: {glass: {cost: 16, cost_margin: 1}}"),
            "line 1: classes.glass.cost must lie between 0 and 15");
  EXPECT_EQ(refusal("classes: {a/b: {margin: 1}}"), "line 1: 'a/b' is no name of a class");
  EXPECT_EQ(refusal("classes: [glass]"), "line 1: classes must hold one entry per class of labels");
  EXPECT_EQ(refusal("classes: {glass: {margin: 1}, glass: {margin: 2}}"), "line 1: classes.glass is given twice");
  EXPECT_EQ(refusal("classes: {glass: {margin: 1, cost: 4, cost_margin: 1.1}}"), "accepted");
}

TEST_F(SiteFile, the_effective_values_are_a_site_file) {
  const Site again = load(to_yaml(load(kEveryKey)));
  EXPECT_EQ(to_yaml(again), to_yaml(load(kEveryKey)));
}

TEST_F(SiteFile, an_empty_file_gives_the_defaults) {
  Site defaults;
  defaults.state = directory_ / "state";
  EXPECT_EQ(to_yaml(load("")), to_yaml(defaults));
  EXPECT_EQ(to_yaml(load("agents:\nmerge:\n")), to_yaml(defaults));
}

TEST_F(SiteFile, unknown_keys_are_errors_with_their_line) {
  EXPECT_EQ(refusal("resolution: 0.1\ncolour: red\n"), "line 2: unknown key site.colour");
  EXPECT_EQ(refusal("merge:\n  policy: mean\n  polcy: mean\n"), "line 3: unknown key merge.polcy");
  EXPECT_EQ(refusal("agents:\n  a: {wieght: 3}\n"), "line 2: unknown key agents.a.wieght");
}

TEST_F(SiteFile, a_key_given_twice_is_an_error) {
  EXPECT_EQ(refusal("resolution: 0.1\nresolution: 0.2\n"), "line 2: site.resolution is given twice");
}

TEST_F(SiteFile, wrong_types_and_ranges_are_errors_with_their_line) {
  EXPECT_EQ(refusal("resolution: wide\n"), "line 1: site.resolution has the wrong type");
  EXPECT_EQ(refusal("state: x\nresolution: 0.001\n"), "line 2: site.resolution must lie between 0.005 and 1");
  EXPECT_EQ(refusal("resolution: .nan\n"), "line 1: site.resolution must lie between 0.005 and 1");
  EXPECT_EQ(refusal("agents:\n  a: {weight: 1001}\n"), "line 2: agents.a.weight must lie between 1 and 1000");
  EXPECT_EQ(refusal("agents:\n  a: {kind: 'x y'}\n").substr(0, 21), "line 2: agents.a.kind");
  EXPECT_EQ(refusal("agents:\n  ../a: {weight: 1}\n").substr(0, 24), "line 2: agent id ../a mu");
  EXPECT_EQ(refusal("agents: [a, b]\n"), "line 1: agents must hold one entry per agent id");
  EXPECT_EQ(refusal("merge: mean\n"), "line 1: merge must hold keys and values");
  EXPECT_EQ(refusal("merge: {policy: best}\n"), "line 1: merge.policy must be mean or table");
  EXPECT_EQ(refusal("planner: {zmin: 2.0}\n"), "planner.zmin must be below planner.zmax");
  EXPECT_EQ(refusal("planner: {free_share: 0}\n"), "line 1: planner.free_share must be above 0, at most 1");
  EXPECT_EQ(refusal("planner: {free_share: .nan}\n"), "line 1: planner.free_share must be above 0, at most 1");
  EXPECT_EQ(refusal("planner: {free_share: 1}\n"), "accepted");
  EXPECT_NE(refusal("- a\n- b\n"), "accepted");
  EXPECT_NE(refusal("a: [\n"), "accepted");
  EXPECT_NE(refusal("? [a, b]\n: c\n"), "accepted");
}

TEST_F(SiteFile, a_file_that_is_not_there_is_named) {
  try {
    (void)load_site(directory_ / "none.yaml");
    FAIL();
  } catch (const ConfigError& e) {
    EXPECT_NE(std::string(e.what()).find("none.yaml: cannot be read"), std::string::npos);
  }
}

TEST_F(SiteFile, the_state_folder_has_a_name) {
  EXPECT_EQ(refusal("resolution: 0.1\nstate: ''\n").substr(0, 33), "line 2: site.state must be a fold");
  EXPECT_EQ(refusal("state:\n"), "line 1: site.state has no value");
}

TEST_F(SiteFile, a_url_that_lcm_cannot_use_is_told_with_what_is_wrong_and_what_is_right) {
  const auto says = [&](const std::string& url, const std::string& what) {
    const std::string said = refusal("lcm_url: \"" + url + "\"\nbeyond_host: true\n");
    EXPECT_EQ(said.rfind("line 1: lcm_url " + url, 0), 0U) << said;
    EXPECT_NE(said.find(what), std::string::npos) << said;
    EXPECT_NE(said.find("udpm://239.255.76.67:7667?ttl=0"), std::string::npos) << said;
  };
  says("5", "is no url");
  says("", "is no url");
  says("tcp://127.0.0.1:7700", "'tcp'");
  says("udpm://127.0.0.1:7667?ttl=0", "'127.0.0.1', which is no multicast");
  says("udpm://240.0.0.1:7667?ttl=0", "no multicast");
  says("udpm://239.255.76:7667?ttl=0", "no multicast");
  says("udpm://host:7667?ttl=0", "no multicast");
  says("udpm://", "no multicast");
  says("mpudpm://10.0.0.1:7667?ttl=0", "no multicast");
  for (const char* port : {"0", "65536", "-1", "x", "", "7667 ", "99999999999"}) {
    says("udpm://239.255.76.67:" + std::string(port) + "?ttl=0", "the port '" + std::string(port) + "'");
  }
  says("udpm://239.255.76.67", "the port ''");
  for (const char* ttl : {"x", "", "256", "-1"}) {
    says("udpm://239.255.76.67:7667?recv_buf_size=5&ttl=" + std::string(ttl), "ttl");
  }
  for (const char* url : {"udpm://224.0.0.1:1?ttl=255", "udpm://239.255.255.255:65535", "tcpq://10.0.0.1:7700"}) {
    EXPECT_EQ(refusal("lcm_url: " + std::string(url) + "\nbeyond_host: true\n"), "accepted");
  }
}

TEST_F(SiteFile, packets_leave_the_host_only_when_that_is_said) {
  EXPECT_EQ(refusal("lcm_url: udpm://239.255.76.67:7667?ttl=1\n").substr(0, 11), "lcm_url has");
  EXPECT_EQ(refusal("lcm_url: udpm://239.255.76.67:7667?ttl=01\n").substr(0, 11), "lcm_url has");
  EXPECT_EQ(refusal("lcm_url: udpm://239.255.76.67:7667\n").substr(0, 11), "lcm_url has");
  EXPECT_EQ(refusal("lcm_url: udpm://239.255.76.67:7667?xttl=0\n").substr(0, 11), "lcm_url has");
  EXPECT_EQ(refusal("lcm_url: udpm://239.255.76.67:7667?ttl=0&ttl=5\n").substr(0, 11), "lcm_url has");
  EXPECT_EQ(refusal("lcm_url: mpudpm://239.255.76.67:7667?ttl=1\n").substr(0, 11), "lcm_url has");
  EXPECT_EQ(refusal("lcm_url: tcpq://127.0.0.1:7700\n").substr(0, 11), "lcm_url has");
  EXPECT_EQ(refusal("lcm_url: udpm://239.255.76.67:7667?recv_buf_size=5&ttl=0\n"), "accepted");
  EXPECT_EQ(refusal("lcm_url: memq://\n"), "accepted");
  EXPECT_EQ(refusal("lcm_url: udpm://239.255.76.67:7667?ttl=1\nbeyond_host: true\n"), "accepted");
}

}  // namespace
}  // namespace concord::test
