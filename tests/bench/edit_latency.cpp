#include "edit_latency.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <memory>
#include <random>
#include <set>
#include <stdexcept>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "agent/submap_publisher.hpp"
#include "bus/messages_label.hpp"
#include "core/compose.hpp"
#include "process.hpp"
#include "station.hpp"

namespace concord::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kRounds = 2000;
constexpr int kWarmUp = 200;
constexpr int kLabelRounds = 200;
constexpr double kResolution = 0.05;
constexpr int kPatience = 5000;  // milliseconds
const char* const kPrograms = CONCORD_PROGRAMS;

/// Half-known bricks in a slab as wide as it is long, three bricks high.
BrickMap made_up_map(std::int64_t voxels) {
  std::mt19937 random(1);
  const auto side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(voxels) / (256.0 * 3))));
  BrickMap map;
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      for (int z = 0; z < 3; ++z) {
        DenseBrick dense;
        for (LogOdds& value : dense) {
          const std::uint32_t dice = random() & 15;
          value = dice < 8 ? kUnknown : dice < 14 ? kFree : kOccupied;
        }
        map.set({x, y, z}, Brick::from_dense(dense));
      }
    }
  }
  return map;
}

/// The stack's folder, gone with this object.
class Folder {
 public:
  explicit Folder(const std::filesystem::path& parent) {
    std::string name = (parent / "concord-bench-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a folder in " + parent.string());
    path_ = name;
    std::ofstream(path_ / "site.yaml") << "lcm_url: " << test::kUrl
                                       << "\nbeyond_host: true\nstate: state\nresolution: " << kResolution << "\n";
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Sends back whatever it hears, by LCM alone: the bare round trip.
class Echo {
 public:
  explicit Echo(const test::Host& host) {
    host.inside([this] {
      id_ = fork();
      if (id_ == 0) serve();
    });
    if (id_ < 0) throw std::runtime_error("cannot fork");
  }
  ~Echo() {
    kill(id_, SIGKILL);
    waitpid(id_, nullptr, 0);
  }
  Echo(const Echo&) = delete;
  Echo& operator=(const Echo&) = delete;

 private:
  [[noreturn]] static void serve() {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    lcm::LCM lcm(test::kUrl);
    const auto answer = [](const lcm::ReceiveBuffer* buffer, const std::string&, lcm::LCM* to) {
      to->publish("bench/pong", buffer->data, buffer->data_size);
    };
    lcm.subscribeFunction<lcm::LCM*>("bench/ping", answer, &lcm);
    while (lcm.handle() == 0) {
    }
    _exit(1);
  }
  pid_t id_ = -1;
};

/// A person's end of both, on one LCM socket.
class Person {
 public:
  /// LCM opens its sockets where it is first made to listen.
  explicit Person(const test::Host& host) {
    host.inside([this] {
      lcm_ = std::make_unique<lcm::LCM>(test::kUrl);
      listen();
    });
  }

  /// Microseconds.
  double ping(const Bytes& bytes) {
    const int before = pongs_;
    return timed("bench/ping", bytes, [&] { return pongs_ > before; });
  }
  double edit(const EditRequest& request) {
    const std::int64_t before = version_;
    return timed("in/edit", encode(request), [&] { return version_ > before; });
  }

  /// Until whoever does it has answered. @throws std::runtime_error if that is no.
  Answer ask(const char* channel, const Bytes& bytes, const std::string& id, double& took) {
    do {  // BUSY: it does not know the whole map yet
      last_ = {};
      took = timed(channel, bytes, [&] { return last_.id == id; });
    } while (last_.code == "BUSY");
    if (!last_.ok) throw std::runtime_error(id + ": " + last_.message);
    return last_;
  }

 private:
  void listen() {
    const auto take = [](const lcm::ReceiveBuffer* buffer, const std::string&, Answer* last) {
      const auto answer = decode<Answer>({static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
      if (answer) *last = *answer;
    };
    lcm_->subscribeFunction<Answer*>(kAnswers, take, &last_);
    const auto count = [](const lcm::ReceiveBuffer*, const std::string&, int* pongs) { ++*pongs; };
    lcm_->subscribeFunction<int*>("bench/pong", count, &pongs_);
    const auto note_version = [](const lcm::ReceiveBuffer* buffer, const std::string&, std::int64_t* version) {
      const auto packet = decode<BrickPacket>({static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
      if (packet) *version = std::max(*version, packet->last_version);
    };
    lcm_->subscribeFunction<std::int64_t*>("out/map/bricks", note_version, &version_);
  }

  template <class Happened>
  double timed(const char* channel, const Bytes& bytes, Happened happened) {
    const auto start = Clock::now();
    lcm_->publish(channel, bytes.data(), static_cast<unsigned>(bytes.size()));
    while (!happened()) {
      if (lcm_->handleTimeout(kPatience) <= 0)
        throw std::runtime_error(std::string("no answer on ") + channel + "; the last: " + last_.id + " " +
                                 last_.message);
    }
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  }

  std::unique_ptr<lcm::LCM> lcm_;
  int pongs_ = 0;
  std::int64_t version_ = 0;
  Answer last_;
};

/// A robot that has sent all it has seen.
class Robot {
 public:
  Robot(const test::Host& host, std::string id, const Transform& T_map_agent, const BrickMap& map)
      : id_(std::move(id)), T_map_agent_(T_map_agent), station_(host) {
    host.inside([&] {
      publisher_ = std::make_unique<SubmapPublisher>(
          station_.bus(), station_.counters(), SubmapPublisher::Config{id_, kResolution, 5e6, station_.bus().now()},
          [] {});
      listen<Answer>(station_.bus(), station_.counters(), "bench", kAnswers, [this](const std::string&, Answer answer) {
        placed_ = placed_ || (answer.ok && answer.id == "place-" + id_);
      });
    });
    publisher_->begin_frame("frame1");
    publisher_->publish(map);
  }
  [[nodiscard]] LcmBus& bus() { return station_.bus(); }
  /// Asks to be placed until it is.
  [[nodiscard]] bool placed() {
    const std::int64_t now = bus().now();
    if (!placed_ && now >= ask_at_) {
      ask_at_ = now + 300'000;
      bus().publish("in/transform",
                    encode(TransformRequest{"place-" + id_, "bench", id_, "frame1", T_map_agent_}, now));
    }
    return placed_;
  }

 private:
  std::string id_;
  Transform T_map_agent_;
  test::Station station_;
  std::unique_ptr<SubmapPublisher> publisher_;
  bool placed_ = false;
  std::int64_t ask_at_ = 0;
};

/// Until the map is what it must be.
void wait_for(const test::Host& host, const BrickMap& expected, const std::vector<std::unique_ptr<Robot>>& robots) {
  test::StreamCopy copy(host, "out/map", kResolution);
  std::vector<LcmBus*> buses{&copy.bus()};
  for (const auto& robot : robots) buses.push_back(&robot->bus());
  const auto done = [&] {
    const auto placed = std::ranges::count_if(robots, [](const auto& robot) { return robot->placed(); });
    return placed == std::ssize(robots) && copy.synced() && copy.map() == expected;
  };
  if (!test::eventually(buses, done)) throw std::runtime_error("the map did not come up");
}

/// Voxels all over the map where adding one changes it.
class Places {
 public:
  explicit Places(const BrickMap& map) : map_(map), bricks_(map.sorted_bricks()) {}
  VoxelIndex next() {
    for (;;) {
      const VoxelIndex voxel =
          voxel_at(bricks_[random_() % bricks_.size()], static_cast<int>(random_() % kBrickVoxels));
      if (!is_occupied(map_.at(voxel)) && taken_.insert(voxel).second) return voxel;
    }
  }

 private:
  const BrickMap& map_;
  std::vector<BrickIndex> bricks_;
  std::set<VoxelIndex> taken_;
  std::mt19937 random_{2};
};

EditRequest one_voxel(int number, VoxelIndex voxel) {
  EditRequest request;
  request.id = "bench-" + std::to_string(number);
  request.author = "bench";
  request.shape = VoxelList{kResolution, {{voxel, voxel}}};
  return request;
}

}  // namespace

Latency latency_of(std::vector<double> samples) {
  std::ranges::sort(samples);
  return {samples[samples.size() / 2], samples[samples.size() * 99 / 100]};
}

namespace {

/// Half a brick of the map.
LabelRequest label_half(const std::vector<BrickIndex>& bricks, std::int32_t number, std::int32_t classes) {
  const VoxelIndex low = origin_of(bricks[static_cast<std::size_t>(number / 2) % bricks.size()]);
  const std::int32_t z = low.z + number % 2 * 4;
  LabelRequest request;
  request.id = "bench-" + std::to_string(number);
  request.author = "bench";
  request.name = "class " + std::to_string(number % classes);
  request.shape = VoxelList{kResolution, {{{low.x, low.y, z}, {low.x + 7, low.y + 7, z + 3}}}};
  return request;
}

}  // namespace

LabelLatency measure_labels(std::int64_t voxels, std::int32_t instances, std::int32_t classes,
                            const std::filesystem::path& state) {
  const Folder folder(state);
  const test::Host host("bench");
  host.run("ip route add 224.0.0.0/4 dev lo");
  const std::string site = folder.path() / "site.yaml";
  std::vector<std::unique_ptr<test::Process>> processes;
  for (const char* name : {"ingest", "merge", "semantic"}) {
    const std::vector<std::string> command{std::string(kPrograms) + "/concord-" + name, "--site", site};
    processes.push_back(std::make_unique<test::Process>(host, command, folder.path() / "log"));
  }
  const Echo echo(host);
  const BrickMap map = made_up_map(voxels);
  std::vector<std::unique_ptr<Robot>> robots;
  robots.push_back(std::make_unique<Robot>(host, "robot1", Transform::Identity(), map));
  wait_for(host, map, robots);

  Person person(host);
  const std::vector<BrickIndex> bricks = map.sorted_bricks();
  double took = 0;
  std::int32_t number = 0;
  const auto label = [&] {
    const LabelRequest request = label_half(bricks, number++, classes);
    person.ask("in/label", encode(request), request.id, took);
    robots[0]->bus().spin_once(0);
    return request;
  };
  while (number < instances) label();
  std::vector<double> round_trips, labels, take_offs, removals;
  for (int i = 0; i < kLabelRounds; ++i) {
    LabelRequest request = label_half(bricks, number, classes);
    round_trips.push_back(person.ping(encode(request)));
    label();
    labels.push_back(took);
    const auto change = [&](LabelRequest::Op op, const char* mark, std::int32_t of) {
      request.op = op;
      request.id = mark + std::to_string(number);
      // The first of a class is its first instance; each class comes in its turn.
      request.of = {static_cast<ClassId>(of % classes + 1), static_cast<std::uint32_t>(of / classes + 1)};
      person.ask("in/label", encode(request), request.id, took);
    };
    change(LabelRequest::Op::kTakeOff, "off-", number - 1);
    take_offs.push_back(took);
    change(LabelRequest::Op::kDelete, "gone-", i);
    removals.push_back(took);
  }
  return {static_cast<std::int64_t>(map.known_count()), latency_of(round_trips), latency_of(labels),
          latency_of(take_offs), latency_of(removals)};
}

EditLatency measure_edits(const EditCase& given, const std::filesystem::path& state) {
  const Folder folder(state);
  const test::Host host("bench");
  host.run("ip route add 224.0.0.0/4 dev lo");
  const std::string site = folder.path() / "site.yaml";
  std::vector<std::unique_ptr<test::Process>> processes;
  for (const std::string& name : given.processes) {
    const std::vector<std::string> command{std::string(kPrograms) + "/concord-" + name, "--site", site};
    processes.push_back(std::make_unique<test::Process>(host, command, folder.path() / "log"));
  }
  const Echo echo(host);
  const BrickMap submap = made_up_map(given.voxels / std::ssize(given.T_map_agents));
  std::vector<Layer> layers;
  std::vector<std::unique_ptr<Robot>> robots;
  for (const Transform& T : given.T_map_agents) {
    layers.push_back({&submap, T, 1});
    robots.push_back(std::make_unique<Robot>(host, "robot" + std::to_string(robots.size() + 1), T, submap));
  }
  const BrickMap map = compose(layers, {}, Policy::kMean, kResolution).values;
  wait_for(host, map, robots);

  Person person(host);
  Places places(map);
  std::vector<double> round_trips, edits;
  for (int i = 0; i < kWarmUp + kRounds; ++i) {
    const EditRequest request = one_voxel(i, places.next());
    const double ping = person.ping(encode(request));
    const double edit = person.edit(request);
    if (i >= kWarmUp) {
      round_trips.push_back(ping);
      edits.push_back(edit);
    }
    for (const auto& robot : robots) robot->bus().spin_once(0);
  }
  return {static_cast<std::int64_t>(map.known_count()), latency_of(round_trips), latency_of(edits)};
}

}  // namespace concord::bench
