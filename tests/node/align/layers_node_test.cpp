#include "bus/layers_node.hpp"
#include "align_station.hpp"

namespace concord::test {
namespace {

class Layers : public ::testing::Test {
 protected:
  void begin(const std::string& frame_id) {
    sender_.begin(frame_id);
    bus_.advance_to(bus_.now() + 2'000'000);
  }
  void say_place(const std::string& frame_id, const Transform& T_map_agent) {
    AgentState state;
    state.id = "robot1";
    state.frame_id = frame_id;
    state.aligned = true;
    state.T_map_agent = T_map_agent;
    state.weight = 7;
    bus_.publish("out/agents", encode(AgentList{bus_.now(), kResolution, {state}}));
    bus_.deliver();
  }
  [[nodiscard]] std::optional<Transform> place() { return layers_.now().at("robot1").T_map_agent; }

  LockstepBus bus_{1'000'000'000};
  Counters counters_;
  Site site_ = [] {
    Site site;
    site.resolution = kResolution;
    return site;
  }();
  LayersNode layers_{NodeContext{bus_, counters_, site_, "align", bus_.now()}};
  BrickMap map_ = voxels_of(left_part());
  BrickSender sender_{bus_, counters_, BrickSender::Config{"out/agent/robot1", site_.resolution, 5e8, bus_.now(), 1},
                      map_};
};

TEST_F(Layers, AnAgentOnANewFrameLiesWhereTheLastListPutThatFrame) {
  begin("frame1");
  EXPECT_FALSE(place());
  say_place("frame2", transform(1, 2, 0, 0.5));
  EXPECT_FALSE(place()) << "that is of another frame";
  begin("frame2");
  ASSERT_TRUE(place()) << "it would lie nowhere until the next list";
  EXPECT_TRUE(place()->isApprox(transform(1, 2, 0, 0.5), 1e-9));
  EXPECT_EQ(layers_.now().at("robot1").weight, 7);
}

TEST_F(Layers, APlaceHoldsForTheFrameItWasFoundIn) {
  begin("frame1");
  say_place("frame1", transform(1, 2, 0, 0.5));
  ASSERT_TRUE(place());
  begin("frame2");
  EXPECT_FALSE(place());
}

}  // namespace
}  // namespace concord::test
