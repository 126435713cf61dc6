#include <algorithm>
#include <random>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "merge/edit_evaluation.hpp"
#include "people_station.hpp"

// The process, through anything that robots and people can do, against the same told plainly.

namespace concord {
namespace {

Brick random_brick(std::mt19937& random) {
  DenseBrick dense;
  for (LogOdds& l : dense) {
    const auto roll = random() % 10;
    l = roll < 5 ? kUnknown : roll < 8 ? kFree : roll < 9 ? kOccupied : static_cast<LogOdds>(random() % 4000 - 2000);
  }
  return Brick::from_dense(dense);
}

/// One that comes out of a message as it went in.
Transform random_transform(std::mt19937& random) {
  const auto uniform = [&](double width) { return (static_cast<double>(random() % 2001) / 1000.0 - 1.0) * width; };
  const Eigen::Quaterniond q(Eigen::AngleAxisd(uniform(3.1), Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(uniform(0.2), Eigen::Vector3d::UnitX()));
  const Eigen::Vector3d position(uniform(2), uniform(2), uniform(0.5));
  const TransformRequest sent{"t", "eva", "robot", "", *make_transform(position, q.coeffs())};
  return decode<TransformRequest>(encode(sent, 1))->T_map_agent;
}

/// What there is, kept as plainly as can be: nothing here knows what changed.
struct Plain {
  struct Agent {
    std::string frame_id;
    std::int64_t incarnation = 0;
    BrickMap map;
  };
  struct Edit {
    std::string id;
    Correction::Edit what;
    bool active = true;
  };
  std::map<std::string, Agent> agents;
  std::map<std::string, int> weights;
  std::map<std::tuple<std::string, std::string, std::int64_t>, Transform> placed;
  std::vector<Edit> edits;
  std::vector<std::string> zones;

  [[nodiscard]] int weight(const std::string& agent) const { return weights.contains(agent) ? weights.at(agent) : 1; }
  [[nodiscard]] MergedMap merged(Policy policy, double resolution) const {
    std::vector<Layer> layers;
    for (const auto& [id, agent] : agents) {
      const auto T = placed.find({id, agent.frame_id, agent.incarnation});
      if (T != placed.end()) layers.push_back({&agent.map, T->second, weight(id)});
    }
    PinMap pins;
    for (const Edit& edit : edits) {
      if (!edit.active) continue;
      for (const VoxelIndex v : edit.what.added) pins.set(v, PinMap::Pin::kAdded);
      for (const VoxelIndex v : edit.what.deleted) pins.set(v, PinMap::Pin::kDeleted);
    }
    return compose(layers, pins, policy, resolution);
  }
};

class World : public PeopleStation {
 public:
  explicit World(std::uint32_t seed) : random_(seed) {
    site_.merge.policy = seed % 3 == 0 ? Policy::kTable : Policy::kMean;
    restart_merge();
  }
  void TestBody() override {}

  void do_anything() {
    const std::string agent = "robot" + std::to_string(random_() % 3);
    const auto roll = random_() % 20;
    if (!plain_.agents.contains(agent)) return join(agent);
    if (roll == 0) return begin_anew(agent);
    if (roll == 1) return remove(agent);
    if (roll == 2) return restart_merge();
    if (roll <= 4) return place(agent);
    if (roll == 5) return localise(agent);
    if (roll == 6) return weigh(agent);
    if (roll <= 10) return edit();
    if (roll <= 12) return undo();
    if (roll == 13) return zone();
    if (roll == 14) return set_bricks(agent, 1, true);
    set_bricks(agent, 8, false);
  }

  void check() {
    run(200'000);
    const MergedMap fresh = plain_.merged(site_.merge.policy, site_.resolution);
    RC_ASSERT(node_->map() == fresh.values);
    RC_ASSERT(node_->conflicts() == fresh.conflicts);
    std::vector<std::string> zones;
    for (const Zone& zone : zones_->items()) zones.push_back(zone.name);
    std::ranges::sort(zones);
    std::ranges::sort(plain_.zones);
    RC_ASSERT(zones == plain_.zones);
  }
  /// Who hears the map has the same, be it later.
  void check_heard() {
    run(3'000'000);
    RC_ASSERT(heard_ == node_->map());
  }

 private:
  std::int32_t coordinate(int side) { return static_cast<std::int32_t>(random_() % side) - side / 2; }
  std::string next_id() { return "id" + std::to_string(++ids_); }

  void granted(const std::string& channel, const Bytes& request) {
    const Answer answer = ask(channel, request);
    RC_ASSERT(answer.code == "OK");
  }

  void restart_merge() {
    senders_.clear();
    start();
    for (const auto& [id, agent] : plain_.agents) speak(id);
    run(4'000'000);
  }
  /// As ingest does, for an agent that it has.
  void speak(const std::string& id) {
    const Plain::Agent& agent = plain_.agents.at(id);
    auto& sender = senders_[id];
    sender.reset();
    const BrickSender::Config config{"out/agent/" + id, site_.resolution, 5e6, bus_->now(), agent.incarnation};
    sender = std::make_unique<BrickSender>(*bus_, counters_, config, agent.map);
    sender->begin(agent.frame_id);
  }
  void join(const std::string& id) {
    plain_.agents[id] = {"frame" + std::to_string(random_() % 2), ++incarnations_, {}};
    speak(id);
    run();
  }
  /// A reset, or SLAM that lost itself: the same agent in another frame, or in one that it was in before.
  void begin_anew(const std::string& id) {
    Plain::Agent& agent = plain_.agents.at(id);
    agent.map = BrickMap();
    agent.frame_id = "frame" + std::to_string(random_() % 3);
    senders_.at(id)->begin(agent.frame_id);
    run();
  }
  void remove(const std::string& id) {
    plain_.agents.erase(id);
    senders_.at(id)->end();
    run();
    senders_.erase(id);
  }
  void set_bricks(const std::string& id, int count, bool empty) {
    BrickMap& map = plain_.agents.at(id).map;
    for (int i = 0; i < count; ++i) {
      const BrickIndex index{coordinate(5), coordinate(5), coordinate(5)};
      map.set(index, empty ? Brick{} : random_brick(random_));
      senders_.at(id)->touch(index);
    }
  }

  void place(const std::string& id) {
    const Transform T = random_() % 4 == 0 ? Transform::Identity() : random_transform(random_);
    granted("in/transform", encode(TransformRequest{next_id(), "eva", id, "", T}, bus_->now()));
    keep_placed(id, T);
  }
  /// A person saw the robot, where it said it was at that time.
  void localise(const std::string& id) {
    const Transform T_agent_base = random_transform(random_), T_map_base = random_transform(random_);
    run(10'000);
    const AgentPose pose{id, plain_.agents.at(id).frame_id, T_agent_base, bus_->now()};
    bus_->publish("in/" + id + "/pose", encode(pose));
    bus_->deliver();
    granted("in/localise", encode(LocaliseRequest{next_id(), "eva", id, T_map_base, {}, pose.utime}));
    const Transform T = T_map_base * T_agent_base.inverse();
    keep_placed(id, *make_transform(T.translation(), Eigen::Quaterniond(T.linear()).coeffs()));
  }
  void keep_placed(const std::string& id, const Transform& T) {
    const Plain::Agent& agent = plain_.agents.at(id);
    plain_.placed[{id, agent.frame_id, agent.incarnation}] = T;
  }
  void weigh(const std::string& id) {
    const int weight = 1 + static_cast<int>(random_() % 1000);
    granted("in/weight", encode(WeightRequest{next_id(), "eva", id, weight}));
    plain_.weights[id] = weight;
  }

  void edit() {
    EditRequest request;
    request.id = next_id();
    request.author = "eva";
    request.op = static_cast<EditRequest::Op>(random_() % 3);
    request.move = {0.1 * coordinate(9), 0.1 * coordinate(9), 0};
    request.utime = bus_->now();
    const VoxelIndex low{coordinate(30), coordinate(30), coordinate(30)};
    const auto side = [&] { return static_cast<std::int32_t>(random_() % 12); };
    request.shape = VoxelList{site_.resolution, {{low, {low.x + side(), low.y + side(), low.z + side()}}}};
    run(100'000);
    const MergedMap now = plain_.merged(site_.merge.policy, site_.resolution);
    const auto pins = evaluate(request, Transform::Identity(), now.values, site_.resolution);
    const Answer answer = ask("in/edit", encode(request));
    RC_ASSERT(answer.ok == pins.has_value());
    if (pins) plain_.edits.push_back({request.id, *pins, true});
  }
  void undo() {
    if (plain_.edits.empty()) return;
    Plain::Edit& edit = plain_.edits[random_() % plain_.edits.size()];
    granted("in/undo", encode(UndoRequest{next_id(), "eva", edit.id, !edit.active, bus_->now()}));
    edit.active = !edit.active;
  }
  void zone() {
    const std::string name = "zone" + std::to_string(random_() % 4);
    ZoneRequest request{next_id(), "eva", ZoneRequest::Op::kAdd, name, {}, Box{{0, 0, 0}, {1, 1, 1}}, {}, -1, 1};
    const bool there = std::ranges::find(plain_.zones, name) != plain_.zones.end();
    if (there) request.op = ZoneRequest::Op::kDelete;
    granted("in/zone", encode(request));
    if (there) std::erase(plain_.zones, name);
    if (!there) plain_.zones.push_back(name);
  }

  std::mt19937 random_;
  Plain plain_;
  std::map<std::string, std::unique_ptr<BrickSender>> senders_;
  int ids_ = 0;
  std::int64_t incarnations_ = 0;
};

RC_GTEST_PROP(NoGhosts, TheMapIsAFreshMergeAfterEachOfAnySteps, (std::uint32_t seed)) {
  World world(seed);
  for (int step = 0; step < 30; ++step) {
    world.do_anything();
    world.check();
  }
  world.check_heard();
}

}  // namespace
}  // namespace concord
