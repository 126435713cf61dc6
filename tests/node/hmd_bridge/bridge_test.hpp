#pragma once

// Every row of what a headset can ask: one test for the answer, one for each way it can fail. What they share.

#include <string>

#include <gtest/gtest.h>

#include "lab.hpp"

namespace concord::hmd {

/// For EXPECT_CODE: what was answered, in whole, when it was not what was expected.
inline testing::AssertionResult has_code(const Json& answer, const std::string& code) {
  if (code_of_answer(answer) == code) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "not " << code << ": " << answer.dump();
}
#define EXPECT_CODE(answer, code) EXPECT_TRUE(has_code((answer), (code)))

inline const Pose kHere{{0, 0, 0}, {0, 0, 0, 1}};

inline Shape box(double x0, double y0, double z0, double x1, double y1, double z1) {
  return Box{{x0, y0, z0}, {x1, y1, z1}};
}
inline EditRequest add(const Shape& shape) { return {EditOp::kAdd, Frame::kMap, shape, {}, {}}; }

/// A lab in which robot1 has mapped a hall and lies in the map, and somebody who works there.
class Bridge : public testing::Test {
 protected:
  explicit Bridge(double resolution = 0.1) : lab(Lab::kAll, resolution) {}

  void place_robot() {
    lab.robot_maps();
    EXPECT_CODE(ana.ask(PlaceRequest{"robot1", kHere}), "OK");
    lab.run(2.5);
    lab.robot_at(1, 1);
    lab.run(1.5);
  }
  /// ana as an agent that the stack knows, and that lies in the map.
  void become_agent(Client& client, const std::string& agent, bool placed) {
    EXPECT_CODE(client.hello(agent), "OK");
    client.note(TrackingNotice{Tracking::kOk, "local1", kHere, {}});
    lab.run(1.5);
    if (placed) {
      EXPECT_CODE(client.ask(PlaceRequest{agent, Pose{{1, 0, 0}, {0, 0, 0, 1}}}), "OK");
    }
    lab.run(1.5);
  }

  Lab lab;
  Client ana{lab};
};

class Working : public Bridge {
 protected:
  void SetUp() override {
    ASSERT_EQ(code_of_answer(ana.hello()), "OK");
    place_robot();
  }
};

inline VoxelLook voxel_look(double resolution, bool any) {
  VoxelLook look{resolution, 0.9, 0.2, Transform::Identity(), {VoxelChunk{{0, 0, 0}, {}, {}}}};
  if (any) look.chunks[0].occupied[0] = 0xFF;
  return look;
}

inline MeshLook floor_look() {
  MeshLook look;
  look.T_own_sensor.translation() = Eigen::Vector3d(0, 0, 1.5);
  look.parts.push_back({1, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  return look;
}

}  // namespace concord::hmd
