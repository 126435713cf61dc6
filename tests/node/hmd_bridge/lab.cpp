#include "lab.hpp"

#include <filesystem>

#include <stdlib.h>

namespace concord::hmd {

Lab::Lab(With with, double resolution) {
  std::string pattern = "/dev/shm/concord-lab-XXXXXX";
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no /dev/shm");
  site.state = pattern;
  site.resolution = resolution;
  site.planner.zmin = 0.1;
  site.planner.zmax = 0.8;
  site.unlisted.radius = 0.2;
  bus = std::make_unique<LockstepBus>(kStart);
  const auto context = [&](const char* process) { return NodeContext{*bus, counters, site, process, bus->now()}; };
  for (const char* process : {"ingest", "merge", "planner"}) publish_status_each_second(context(process));
  if (with != kWithoutAlign) {
    publish_status_each_second(context("align"));
    align = std::make_unique<AlignNode>(context("align"), std::launch::deferred);
  }
  if (with != kWithoutSemantic) {
    publish_status_each_second(context("semantic"));
    restart_semantic();
  }
  if (with != kWithoutIngest) ingest = std::make_unique<IngestNode>(context("ingest"));
  if (with != kWithoutMerge) merge = std::make_unique<MergeNode>(context("merge"));
  planner = std::make_unique<PlannerNode>(context("planner"), std::launch::deferred);
  gate = std::make_unique<Gate>(random_secret);
  restart_bridge();
}

void Lab::restart_bridge() {
  bridge.reset();
  bridge_bus = std::make_unique<PartOfBus>(*bus);
  Hub::Config config = hub_config(site);
  config.local_role = Role::kRobot;
  bridge = std::make_unique<BridgeNode>(NodeContext{*bridge_bus, counters, site, "hmd-bridge", bus->now()}, *gate,
                                        config, std::launch::deferred, "/models/", map_limits);
  run(1.5);
}

void Lab::restart_semantic() {
  semantic.reset();
  semantic_bus = std::make_unique<PartOfBus>(*bus);
  semantic = std::make_unique<SemanticNode>(NodeContext{*semantic_bus, counters, site, "semantic", bus->now()},
                                            std::launch::deferred);
}

Lab::~Lab() {
  sent_.clear();
  bridge.reset();
  semantic.reset();
  align.reset();
  planner.reset();
  merge.reset();
  ingest.reset();
  std::filesystem::remove_all(site.state);
}

void Lab::run(double seconds) {
  bus->advance_to(bus->now() + static_cast<std::int64_t>(seconds * 1e6));
  bus->deliver();
}

bool Lab::run_until(double seconds, const std::function<bool()>& done) {
  for (int i = 0; i < seconds * 100 && !done(); ++i) run(0.01);
  return done();
}

void Lab::robot_maps() {
  VoxelMask all;
  all.fill(~std::uint64_t{0});
  BrickMap map;
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      map.set({x, y, 0}, Brick::uniform(all, kFree));
      VoxelMask top{};
      top[7] = ~std::uint64_t{0};
      map.set({x, y, -1}, Brick::uniform(top, kOccupied));
    }
  }
  agent_maps("robot1", map);
}

void Lab::agent_maps(const std::string& agent, const BrickMap& map) {
  Sent& sent = sent_[agent];
  sent.map = map;
  sent.sender = std::make_unique<BrickSender>(
      *bus, counters, BrickSender::Config{"in/" + agent, site.resolution, 5e6, bus->now()}, sent.map);
  sent.sender->begin("odom");
  for (const BrickIndex index : sent.map.sorted_bricks()) sent.sender->touch(index);
  run(3);
}

void Lab::robot_at(double x, double y) {
  AgentPose pose{"robot1", "odom", Transform::Identity(), bus->now()};
  pose.T_agent_base.translation() = Eigen::Vector3d(x, y, 0);
  bus->publish("in/robot1/pose", encode(pose));
  bus->deliver();
}

Client::Client(Lab& lab, Peer peer) : lab_(lab) { connection = lab.bridge->hub().open(peer, lab.bus->now()).value(); }

Json Client::hello(const std::string& agent, const std::string& frame_id) {
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "ana";
  hello.device = "test";
  if (!agent.empty()) {
    hello.agent = agent;
    hello.frame_id = frame_id;
  }
  Json answer = ask(hello);
  note(CreditNotice{1'000'000'000});
  return answer;
}

Json Client::ask_text(std::int64_t id, const std::string& text) {
  lab_.bridge->hub().text(connection, text, lab_.bus->now());
  lab_.run_until(130, [&] {
    read();
    return answers.contains(id);
  });
  return answers[id];
}

Json Client::upload(FrameKind kind, std::uint32_t count, std::int64_t sequence, const Bytes& payload) {
  const std::int64_t id = ++id_;
  const FrameHead head{.kind = kind, .stream = static_cast<std::uint32_t>(id), .count = count, .revision = sequence};
  lab_.bridge->hub().binary(connection, make_frame(head, payload), lab_.bus->now());
  lab_.run_until(12, [&] {
    read();
    return answers.contains(id);
  });
  return answers[id];
}

void Client::read() {
  while (const auto next = lab_.bridge->hub().next(connection)) {
    if (const auto* text = std::get_if<SharedText>(&*next)) {
      Json json = Json::parse(**text);
      if (json.contains("event")) {
        events[json["event"]] = json["body"];
      } else {
        answers[json["id"]] = json;
      }
      continue;
    }
    const FramePointer frame = std::get<FramePointer>(*next);
    bytes += static_cast<std::int64_t>(frame->size());
    frames.push_back(read_frame(*frame).value());
  }
}

std::string code_of_answer(const Json& answer) {
  if (answer.contains("error")) return answer["error"]["code"];
  return answer.contains("answer") ? "OK" : "none";
}

}  // namespace concord::hmd
