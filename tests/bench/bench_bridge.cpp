// The bridge beside a bare Beast server that sends identical frames, over TLS, in one run: README.md.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <future>
#include <map>
#include <random>
#include <thread>

#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "merge/merge_node.hpp"
#include "protocol/control.hpp"
#include "rig.hpp"
#include "tls_client.hpp"

namespace concord::hmd {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr double kResolution = 0.05;
/// The two servers take turns, so that neither has the machine's better minutes; 200 answers are a 95th percentile,
/// 40 are not.
constexpr int kTurns = 5;

/// A building as a noisy sensor sees it: rooms of 6 m, walls and floors whose voxels jump by one and have holes.
BrickMap noisy_building(std::int64_t voxels) {
  std::mt19937 random(7);
  std::map<BrickIndex, VoxelMask> bricks;
  std::int64_t count = 0;
  const auto put = [&](std::int32_t x, std::int32_t y, std::int32_t z) {
    const VoxelIndex voxel{x, y, z};
    const auto local = static_cast<std::size_t>(local_of(voxel));
    std::uint64_t& word = bricks[brick_of(voxel)][local / 64];
    const std::uint64_t bit = std::uint64_t{1} << (local % 64);
    if ((word & bit) == 0) ++count;
    word |= bit;
  };
  const auto noise = [&] {
    return static_cast<std::int32_t>(random() % 8 == 0) - static_cast<std::int32_t>(random() % 8 == 0);
  };
  const auto seen = [&] { return random() % 10 != 0; };
  constexpr std::int32_t kRoom = 120, kHeight = 56;
  for (std::int32_t room = 0; count < voxels; ++room) {
    const std::int32_t x0 = room % 8 * kRoom, y0 = room / 8 * kRoom;
    for (std::int32_t i = 0; i < kRoom && count < voxels; ++i) {
      for (std::int32_t j = 0; j < kRoom; ++j) {
        if (seen()) put(x0 + i, y0 + j, noise());
      }
      for (std::int32_t z = 0; z < kHeight; ++z) {
        if (seen()) put(x0 + i, y0 + noise(), z);
        if (seen()) put(x0 + noise(), y0 + i, z);
      }
    }
  }
  BrickMap map;
  for (const auto& [index, mask] : bricks) map.set(index, Brick::uniform(mask, kOccupied));
  return map;
}

/// Merge and one agent's submap, in the server's thread.
struct Stack {
  Stack(const NodeContext& context, const BrickMap& submap)
      : merge({context.bus, context.counters, context.site, "merge", context.boot_id}),
        sender(context.bus, context.counters, {"out/agent/robot1", kResolution, 2e8, context.boot_id}, submap) {
    sender.begin("odom");
    for (const BrickIndex index : submap.sorted_bricks()) sender.touch(index);
  }
  MergeNode merge;
  BrickSender sender;
};

bool says(const std::string& text, const char* what) { return text.find(what) != std::string::npos; }

/// A client that is in, with all credit it may ever want.
std::unique_ptr<TlsClient> enter(std::uint16_t port, const std::optional<std::string>& agent = {}) {
  auto client = std::make_unique<TlsClient>(port);
  if (client->upgrade("localhost") != 101) throw std::runtime_error("the bridge lets nobody in");
  HelloRequest hello;
  hello.version = kProtocol;
  hello.device = "bench";
  hello.agent = agent;
  if (agent) hello.frame_id = "local1";
  client->send_text(request_text(1, hello));
  client->send_text(notice_text(CreditNotice{std::int64_t{1} << 50}));
  if (!client->read_text([](const std::string& t) { return says(t, "\"answer\""); }))
    throw std::runtime_error("no hello");
  return client;
}

const ViewRequest kAll{Layer::kMap, {}, Frame::kMap, {0, 0, 0}, {10'000}, {}};

/// Everything once. @return the bytes of binary frames; they are appended to `kept` if given.
std::int64_t look(TlsClient& client, std::int64_t& id, std::vector<std::shared_ptr<const Bytes>>* kept = nullptr) {
  client.send_text(request_text(++id, kAll));
  std::int64_t bytes = 0;
  while (auto message = client.read(60)) {
    if (message->text) {
      if (says(message->data, "\"complete\"")) return bytes;
      continue;
    }
    bytes += static_cast<std::int64_t>(message->data.size());
    if (kept != nullptr) kept->push_back(std::make_shared<const Bytes>(message->data.begin(), message->data.end()));
  }
  throw std::runtime_error("the view did not become complete");
}

using Stop = std::shared_future<void>;

/// A look that costs most for its 2 kB: sheets one above the other, as many cells as one may meet.
Bytes costly_look() {
  MeshLook look;
  look.T_own_sensor.translation() = Eigen::Vector3d(0, 0, 1.5);
  constexpr float kHalf = 3.5F;
  for (std::uint32_t i = 0; i < 24; ++i) {
    const float z = 0.1F * static_cast<float>(i) + 0.02F;
    look.parts.push_back({i + 1,
                          {{-kHalf, -kHalf, z}, {kHalf, -kHalf, z}, {kHalf, kHalf, z}, {-kHalf, kHalf, z}},
                          {{0, 1, 2}, {0, 2, 3}}});
  }
  return mesh_payload(look);
}

struct Uploads {
  std::int64_t taken = 0, refused = 0;

  void operator+=(const Uploads& more) { taken += more.taken, refused += more.refused; }
};

/// A headset that means no good: costly looks, eight a second, whatever is said to it.
Uploads upload_much(std::uint16_t port, const Stop& stop) {
  const auto client = enter(port, "hostile");
  const Bytes payload = costly_look();
  Uploads uploads;
  std::uint32_t id = 1;
  for (auto due = Clock::now(); stop.wait_until(due) == std::future_status::timeout;
       due += std::chrono::milliseconds(125)) {
    const FrameHead head{
        .kind = FrameKind::kMesh, .stream = ++id, .count = 24, .revision = static_cast<std::int64_t>(id)};
    client->send_binary(make_frame(head, payload));
    while (const auto text = client->read(0.001)) {
      if (says(text->data, "\"occupied\"")) ++uploads.taken;
      if (says(text->data, "\"RATE\"")) ++uploads.refused;
    }
  }
  return uploads;
}

/// What a server has done, in all its turns.
struct Load {
  double bytes = 0, seconds = 0;
  std::vector<double> acks;  ///< milliseconds

  [[nodiscard]] double bytes_per_second() const { return bytes / seconds; }
};

/// One turn: runs `client()` in a thread each, and `ack(acks, stop)` beside them.
template <class Client, class Ack>
void run_load(Load& load, int clients, Client client, Ack ack) {
  std::atomic<std::int64_t> bytes = 0;
  std::promise<void> over;
  const Stop stop = over.get_future().share();
  std::thread acks([&] { ack(load.acks, stop); });
  const auto start = Clock::now();
  std::vector<std::thread> threads;
  for (int i = 0; i < clients; ++i) threads.emplace_back([&] { bytes += client(); });
  for (std::thread& thread : threads) thread.join();
  load.bytes += static_cast<double>(bytes);
  load.seconds += seconds_since(start);
  over.set_value();
  acks.join();
}

double percentile95(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[(values.size() - 1) * 95 / 100];
}

/// Ten times a second until `stop`: how long from a message to its answer.
template <class Once>
void ten_a_second(std::vector<double>& acks, const Stop& stop, Once once) {
  for (auto due = Clock::now(); stop.wait_until(due) == std::future_status::timeout;
       due += std::chrono::milliseconds(100)) {
    const auto start = Clock::now();
    once();
    acks.push_back(seconds_since(start) * 1000);
  }
}

std::int64_t resident_kilobytes() {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("VmRSS:")) return std::stoll(line.substr(6));
  }
  return 0;
}

/// Until the bridge has all of it in the map.
void place_submap(Rig& rig, const BrickMap& submap) {
  rig.wait_for(
      [](BridgeNode& node) { return node.world().agent("robot1") != nullptr && node.world().agent("robot1")->synced; });
  rig.in_server([](BridgeNode&, Bus& bus) {
    bus.publish(
        "in/transform",
        encode(TransformRequest{"place", "bench", "robot1", "odom", Transform::Identity(), bus.now()}, bus.now()));
  });
  const std::size_t expected = submap.brick_count();
  rig.wait_for([&](BridgeNode& node) {
    return node.world().map().map().brick_count() >= expected && node.world().map().synced();
  });
}

void print(const Json& result) {
  const auto of = [&](const char* key) { return result.at(key).get<double>(); };
  std::printf(
      "first view of %.0f voxels: %.0f bytes\n%.0f clients: %.0f MB/s, bare server %.0f MB/s: %.0f %%\n"
      "edit answered within %.1f ms (p95), bare echo %.1f ms: %.1f times\n",
      of("voxels"), of("first_view_bytes"), of("clients"), of("bridge_mb_per_s"), of("bare_mb_per_s"),
      of("share_of_bare") * 100, of("ack_p95_ms"), of("echo_p95_ms"), of("ack_p95_over_echo"));
}

int run(int clients, int rounds, std::int64_t voxels, bool json) {
  spdlog::set_level(spdlog::level::warn);
  const BrickMap submap = noisy_building(voxels);
  Rig rig({.header_seconds = 60,
           .idle_seconds = 300,
           .close_seconds = 5,
           .local_role = Role::kEdit,
           .others = [&](const NodeContext& context) { return std::make_shared<Stack>(context, submap); }});
  place_submap(rig, submap);

  std::vector<std::shared_ptr<const Bytes>> frames;
  std::int64_t first_view = 0, id = 1;
  {
    auto client = enter(rig.port());
    first_view = look(*client, id, &frames);
  }

  auto stalled = enter(rig.port());
  stalled->send_text(request_text(2, kAll));  // and reads nothing more
  const std::int64_t memory_before = resident_kilobytes();
  const auto client_of_bridge = [&] {
    auto client = enter(rig.port());
    std::int64_t number = 1, bytes = 0;
    for (int round = 0; round < rounds; ++round) {
      bytes += look(*client, number);
      client->send_text(request_text(++number, ViewCloseRequest{kMapStream}));
    }
    return bytes;
  };
  std::int64_t number = 1;  // each edit is another, in all turns
  const auto edits = [&](std::vector<double>& acks, const Stop& stop) {
    auto client = enter(rig.port());
    ten_a_second(acks, stop, [&] {
      const auto x = static_cast<std::int32_t>(number % 400);
      const EditRequest edit{EditOp::kAdd, Frame::kMap, Voxels{kResolution, {{{x, 30, 20, x, 34, 30}}}}, {}, {}};
      client->send_text(request_text(++number, edit));
      const std::string wanted = "\"id\":" + std::to_string(number) + "}";
      if (!client->read_text([&](const std::string& t) { return says(t, "\"answer\"") && says(t, wanted.c_str()); })) {
        throw std::runtime_error("an edit was not answered");
      }
    });
  };
  BareServer bare(rig.folder() / "cert.pem", rig.folder() / "key.pem", frames);
  const auto client_of_bare = [&] {
    TlsClient client(bare.port());
    if (client.upgrade("localhost") != 101) throw std::runtime_error("no bare server");
    std::int64_t bytes = 0;
    for (int round = 0; round < rounds; ++round) {
      client.send_text("again");
      for (std::size_t i = 0; i < frames.size(); ++i)
        bytes += static_cast<std::int64_t>(client.read(60).value().data.size());
    }
    return bytes;
  };
  const auto echoes = [&](std::vector<double>& acks, const Stop& stop) {
    TlsClient client(bare.port());
    if (client.upgrade("localhost") != 101) throw std::runtime_error("no bare server");
    ten_a_second(acks, stop, [&] {
      client.send_text(
          R"({"id":1,"request":"edit","body":{"op":"add","frame":"map","shape":{"kind":"voxels","resolution":0.05,"boxes":[[1,30,20,1,34,30]]}}})");
      (void)client.read();
    });
  };

  Load bridge, plain;
  Uploads uploads;
  std::int64_t memory_grown = 0;
  for (int turn = 0; turn < kTurns; ++turn) {
    std::promise<void> over;
    std::future<Uploads> uploading =
        std::async(std::launch::async, [&, stop = over.get_future().share()] { return upload_much(rig.port(), stop); });
    run_load(bridge, clients, client_of_bridge, edits);
    over.set_value();
    uploads += uploading.get();
    memory_grown = std::max(memory_grown, resident_kilobytes() - memory_before);
    run_load(plain, clients, client_of_bare, echoes);
  }

  const double share = bridge.bytes_per_second() / plain.bytes_per_second();
  const double ack = percentile95(bridge.acks), echo = percentile95(plain.acks);
  const Json result = {{"share_of_bare", share},
                       {"ack_p95_over_echo", echo > 0 ? ack / echo : 0},
                       {"first_view_bytes", first_view},
                       {"voxels", voxels},
                       {"clients", clients},
                       {"stalled_clients", 1},
                       {"costly_looks", uploads.taken},
                       {"costly_looks_refused", uploads.refused},
                       {"bridge_mb_per_s", bridge.bytes_per_second() / 1e6},
                       {"bare_mb_per_s", plain.bytes_per_second() / 1e6},
                       {"ack_p95_ms", ack},
                       {"echo_p95_ms", echo},
                       {"edits", bridge.acks.size()},
                       {"memory_grown_kb", memory_grown}};
  if (json) {
    std::printf("%s\n", result.dump(2).c_str());
  } else {
    print(result);
  }
  return 0;
}

}  // namespace
}  // namespace concord::hmd

int main(int argc, char** argv) {
  CLI::App app("The bridge beside a bare server that sends identical frames");
  bool json = false;
  int clients = 32, rounds = 20;
  std::int64_t voxels = 1'200'000;
  app.add_flag("--json", json);
  app.add_option("--clients", clients)->check(CLI::Range(1, 60));
  app.add_option("--rounds", rounds, "whole views that each client takes")->check(CLI::Range(1, 1000));
  app.add_option("--voxels", voxels)->check(CLI::Range(1000, 20'000'000));
  CLI11_PARSE(app, argc, argv);
  return concord::hmd::run(clients, rounds, voxels, json);
}
