#include "message_samples.hpp"

namespace concord::test {
namespace {

constexpr std::int64_t kTime = 1'700'000'000'123'456;

template <class T>
Bytes written(const T& value) {
  if constexpr (std::is_same_v<T, EditRequest>) {
    return encode(value, kSampleResolution);
  } else if constexpr (requires { encode(value); }) {
    return encode(value);
  } else {
    return encode(value, kTime);
  }
}

template <class T>
MessageSample sample(const std::string& type, const T& value) {
  return {type, written(value), [](std::span<const std::uint8_t> bytes) -> Decoded<Bytes> {
            auto read = [&] {
              if constexpr (std::is_same_v<T, EditRequest>) {
                return decode_edit(bytes, kSampleResolution);
              } else {
                return decode<T>(bytes);
              }
            }();
            if (!read) return tl::unexpected(read.error());
            return written(*read);
          }};
}

Transform some_transform() {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(1, -2, 3);
  return T;
}

}  // namespace

const std::vector<MessageSample>& message_samples() {
  static const std::vector<MessageSample> kSamples = {
      sample("brick_packet_t", BrickPacket{kTime, 17, "map", 0.05, 3, 9, 2, {1, 2, 3, 255, 0}, 4}),
      sample("brick_digest_t", BrickDigest{kTime, 17, "map", 0.05, 12, 9, 0xFFEEDDCCBBAA9988, 4}),
      sample("brick_request_t", BrickRequest{17, {{1, 2}, {5, 5}, {9, 1'000'000'000'000}}}),
      sample("octomap_t", OctomapMessage{kTime, "odom", 0.1, false, {0, 1, 2, 3}}),
      sample("cloud_t", CloudMessage{kTime, 17, 5, "odom", some_transform(), 12.5, {{1, 2, 3}, {-4, 5.5F, 6}}}),
      sample("agent_pose_t", AgentPose{"", "odom", some_transform(), kTime}),
      sample("frame_over_t", FrameOver{kTime, "odom"}),
      sample("frame_over_t", FrameOver{kTime, "odom"}),
      sample("map_pose_t", MapPose{kTime, "robot1", some_transform()}),
      sample("set_transform_t", TransformRequest{"r-1", "Zoë", "robot1", "odom", some_transform()}),
      sample("edit_t", EditRequest{"e-1", "Zoë", EditRequest::Op::kDelete, {{-1, 0, 0}, {0, 0, 0}, {5, 6, 7}}, kTime}),
      sample("agent_request_t", AgentRequest{"r-2", "robot1", AgentRequest::Op::kRemove}),
      sample("downsample_request_t", DownsampleRequest{"r-3", "robot1", 0.5}),
      sample("downsampled_t", Downsampled{"r-3", "robot1", "odom", 0.5, 1, 2, {{1, 2, 3}}}),
      sample("map_request_t", MapRequest{"r-4", MapRequest::Op::kSave, "hall", "bt", true, ""}),
      sample("map_list_t", MapList{"r-5", {{"a.bt", 100}, {"b.ot", 1LL << 40}}}),
      sample("path_request_t", PathRequest{"r-6", "robot1", Eigen::Vector2d(1, 2), {3, 4}, 0.4, true}),
      sample("path_t", Path{"r-6", "robot1", "OK", "a path", {{1, 2, 0}, {3, 4, 0}}, 2.8, 0.5, 77, 2, true, kTime}),
      sample("answer_t", Answer{"r-1", "merge", true, "OK", "aligned", 5, 6}),
      sample("agents_t", AgentList{kTime,
                                   {{"a", "lidar", "odom", 3, true, some_transform(), 100, 10, 7, true},
                                    {"b", "headset", "h", 1, false, Transform::Identity(), 0, 0, 0, false}}}),
      sample("status_t", ProcessStatus{kTime, "merge", 17, {{"bytes", 5}, {"refused.x", -1}}}),
  };
  return kSamples;
}

}  // namespace concord::test
