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

class RealMapsSystemTest : public SystemTest, public ::testing::WithParamInterface<Pair> {};

TEST_P(RealMapsSystemTest, arrive_whole_and_are_merged_as_files_are) {
  const char* given = std::getenv("CONCORD_DATA");
  const std::filesystem::path data = given != nullptr ? given : CONCORD_SHARED_DATA;
  const std::string a = data / GetParam().a, b = data / GetParam().b;
  if (!std::filesystem::exists(a)) GTEST_SKIP() << a << " is not there; set CONCORD_DATA";

  Stack stack(network(), "resolution: " + std::to_string(GetParam().resolution) +
                             "\nmerge: {policy: " + GetParam().policy + "}\n");
  stack.start_all();
  const Host& person = network().add("person");
  Process first = stack.start_concord(network().add("robot1"), {"--timeout", "100", "publish", a, "--agent", "robot1"});
  Process second =
      stack.start_concord(network().add("robot2"), {"--timeout", "100", "publish", b, "--agent", "robot2"});
  ASSERT_EQ(first.wait(), 0) << stack.logs();
  ASSERT_EQ(second.wait(), 0) << stack.logs();
  stack.concord(person, "set-transform robot1 '0 0 0 0 0 0 1'");
  stack.concord(person, std::string("set-transform robot2 '") + GetParam().transform + "'");

  const auto expected =
      nlohmann::json::parse(stack.concord(person, "--json merge " + a + " " + b + " --transform '" +
                                                      GetParam().transform + "' --policy " + GetParam().policy));
  const std::size_t known = expected["occupied"].get<std::size_t>() + expected["free"].get<std::size_t>();
  const std::size_t conflicting = expected["conflicting"].get<std::size_t>();
  StreamCopy map(person, "out/map", GetParam().resolution);
  StreamCopy conflicts(person, "out/conflicts", GetParam().resolution);
  EXPECT_TRUE(eventually({&map.bus(), &conflicts.bus()},
                         [&] {
                           return map.synced() && conflicts.synced() && map.map().known_count() == known &&
                                  conflicts.map().known_count() == conflicting;
                         }))
      << map.map().known_count() << " of " << known << " voxels, " << conflicts.map().known_count() << " of "
      << conflicting << " conflicts\n"
      << stack.logs();
  EXPECT_EQ(hex(digest(map.map())), expected["digest"]);
}

INSTANTIATE_TEST_SUITE_P(Pairs, RealMapsSystemTest, ::testing::ValuesIn(kPairs),
                         [](const auto& pair) { return std::string(pair.param.name); });

}  // namespace
}  // namespace concord::test
