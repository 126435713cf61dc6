#include "session.hpp"

#include <lcm/lcm-cpp.hpp>

#include "bus/brick_stream.hpp"
#include "bus/lockstep_bus.hpp"

namespace concord::test {
namespace {

constexpr std::int64_t kSecond = 1'000'000;
constexpr std::int64_t kBegin = 1'700'000'000 * kSecond;
constexpr double kResolution = 0.05;
constexpr int kStoreys = 5;  ///< bricks: 2 m

/// Free space with a pillar on every 16th column; `seed` moves them.
Brick brick_of_room(BrickIndex index, int seed) {
  DenseBrick dense;
  for (int local = 0; local < kBrickVoxels; ++local) {
    const VoxelIndex v = voxel_at(index, local);
    const bool pillar = (v.x + seed) % 16 == 0 && (v.y + 3 * seed) % 16 == 0;
    dense[static_cast<std::size_t>(local)] = pillar ? kOccupied : kFree;
  }
  return Brick::from_dense(dense);
}

Transform turned(double yaw, const Eigen::Vector3d& position) {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = position;
  return T;
}

class Robot {
 public:
  Robot(LockstepBus& air, const std::string& id, int seed, int width)
      : sender_(air, counters_, {"in/" + id, kResolution, 5e6, air.now()}, map_),
        hearer_(air, counters_, {"in/" + id, kResolution}, {[](const auto&) {}, [](BrickIndex, Brick) {}, {}}),
        seed_(seed) {
    const StreamChannels channels("in/" + id);
    listen<BrickPacket>(air, counters_, "hearer", channels.bricks,
                        [this](const std::string&, const BrickPacket& packet) { hearer_.on_packet(packet); });
    listen<BrickDigest>(air, counters_, "hearer", channels.digest,
                        [this](const std::string&, const BrickDigest& digest) { hearer_.on_digest(digest); });
    for (int x = 0; x < width; ++x) {
      for (int y = 0; y < 12; ++y) {
        for (int z = 0; z < kStoreys; ++z) map_.set({x, y, z}, brick_of_room({x, y, z}, seed));
      }
    }
    sender_.begin("odom");
  }
  /// The first column of bricks as another seed would have it.
  void change() {
    for (int y = 0; y < 12; ++y) {
      if (map_.set({0, y, 0}, brick_of_room({0, y, 0}, seed_ + 1))) sender_.touch({0, y, 0});
    }
  }

 private:
  Counters counters_;
  BrickMap map_;
  BrickSender sender_;
  BrickReceiver hearer_;  ///< asks for what it misses, as ingest did when this was recorded
  int seed_;
};

CloudMessage scan(std::int64_t utime, std::int64_t sequence) {
  CloudMessage cloud{utime, 1, sequence, "scan", Transform::Identity(), 10.0, {}};
  cloud.T_agent_sensor->translation() = Eigen::Vector3d(0, 0, 1);
  for (int i = 0; i < 500; ++i) {
    const double angle = i * 0.0125 + 0.001 * static_cast<double>(sequence);
    cloud.points.emplace_back(Eigen::Vector3d(3 * std::cos(angle), 3 * std::sin(angle), 1 + 0.001 * i).cast<float>());
  }
  return cloud;
}

EditRequest pane_of_glass(std::int64_t utime) {
  EditRequest edit;
  edit.id = "glass";
  edit.author = "person";
  edit.shape = VoxelList{kResolution, {{{60, 20, 0}, {60, 49, 39}}}};
  edit.utime = utime;
  return edit;
}

}  // namespace

std::vector<LogEvent> record_session() {
  LockstepBus air(kBegin);
  std::vector<LogEvent> events;
  air.subscribe("in/.*", [&](const std::string& channel, std::span<const std::uint8_t> bytes) {
    events.push_back({air.now(), channel, Bytes(bytes.begin(), bytes.end())});
  });
  const auto wait = [&](double seconds) { air.advance_to(air.now() + static_cast<std::int64_t>(seconds * kSecond)); };
  const auto align = [&](const std::string& agent, const Transform& T) {
    air.publish("in/transform", encode(TransformRequest{"align-" + agent, "person", agent, "", T}, air.now()));
  };

  Robot robot1(air, "robot1", 0, 8), robot2(air, "robot2", 5, 6);
  air.publish("in/robot1/pose", encode(AgentPose{"", "odom", turned(0, {1, 1, 0}), air.now()}));
  for (int i = 0; i < 4; ++i) {
    air.publish("in/scanner/cloud", encode(scan(air.now(), i)));
    wait(0.3);
  }
  wait(1.0);
  align("robot1", Transform::Identity());
  align("robot2", turned(0.3, {2.9, 0.2, 0}));
  align("scanner", turned(-1.0, {2, 2, 0.01}));
  wait(0.5);
  robot1.change();
  wait(0.5);
  const Bytes ask = encode(PathRequest{"path", "robot1", std::nullopt, {2.6, 4.2}, 0.1, true, {}}, air.now());
  air.publish("in/path_request", ask);
  wait(0.2);
  air.publish("in/edit", encode(pane_of_glass(air.now())));
  wait(1.2);
  return events;
}

void write_log(const std::filesystem::path& file, const std::vector<LogEvent>& events) {
  lcm::LogFile log(file.string(), "w");
  for (const LogEvent& event : events) {
    Bytes data = event.bytes;
    lcm::LogEvent out{};
    out.timestamp = event.utime;
    out.channel = event.channel;
    out.datalen = static_cast<std::int32_t>(data.size());
    out.data = data.data();
    log.writeEvent(&out);
  }
}

}  // namespace concord::test
