#include <algorithm>
#include <random>
#include <utility>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "merge/layered_map.hpp"
#include "merge/people.hpp"

namespace concord {
namespace {

constexpr double kResolution = 0.1;

Brick random_brick(std::mt19937& random) {
  DenseBrick dense;
  for (LogOdds& l : dense) {
    const auto roll = random() % 10;
    l = roll < 5 ? kUnknown : roll < 8 ? kFree : roll < 9 ? kOccupied : static_cast<LogOdds>(random() % 4000 - 2000);
  }
  return Brick::from_dense(dense);
}

Transform random_transform(std::mt19937& random) {
  const auto uniform = [&](double width) { return (static_cast<double>(random() % 2001) / 1000.0 - 1.0) * width; };
  Transform T = Transform::Identity();
  T.linear() = (Eigen::AngleAxisd(uniform(3.1), Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(uniform(0.2), Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  T.translation() = Eigen::Vector3d(uniform(2), uniform(2), uniform(0.5));
  return T;
}

/// What there is, kept as plainly as can be: nothing here knows what changed.
struct Naive {
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
  std::vector<std::string> zones;  ///< names, in the order in which they were made

  [[nodiscard]] int weight(const std::string& agent) const { return weights.contains(agent) ? weights.at(agent) : 1; }
  [[nodiscard]] MergedMap merged(Policy policy) const {
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
    return compose(layers, pins, policy, kResolution);
  }
};

/// The process and the plain state side by side, through anything that can happen.
class World {
 public:
  explicit World(std::uint32_t seed)
      : random_(seed),
        policy_(seed % 3 == 0 ? Policy::kTable : Policy::kMean),
        people_(kResolution),
        map_(kResolution, policy_, people_.pins()) {}

  void do_anything() {
    const std::string agent = "agent" + std::to_string(random_() % 3);
    const auto roll = random_() % 16;
    if (!naive_.agents.contains(agent) || roll == 0) return new_frame(agent);
    if (roll == 1) return remove(agent);
    if (roll <= 3) return place(agent);
    if (roll == 4) return set_weight(agent);
    if (roll <= 8) return edit();
    if (roll <= 10) return undo();
    if (roll == 11) return zone();
    if (roll == 12) return set_brick(agent, Brick{});
    for (int i = 0; i < 8; ++i) set_brick(agent, random_brick(random_));
  }

  void check() {
    map_.refold();
    const MergedMap fresh = naive_.merged(policy_);
    RC_ASSERT(map_.map() == fresh.values);
    RC_ASSERT(map_.conflicts() == fresh.conflicts);
    RC_ASSERT(people_.zones().size() == naive_.zones.size());
    for (const std::string& name : naive_.zones) RC_ASSERT(people_.zones().contains(name));
  }

  /// What was made, made once more in a new process, is the same.
  void check_restart() {
    People again(kResolution);
    BrickSet touched;
    for (const Correction& correction : stored_) again.apply(correction, touched);
    RC_ASSERT(again.pins() == people_.pins());
    RC_ASSERT(again.revision() == people_.revision());
    RC_ASSERT(again.zones().size() == people_.zones().size());
    const auto ours = people_.history({});
    const auto theirs = again.history({});
    RC_ASSERT(ours.size() == theirs.size());
    for (std::size_t i = 0; i < ours.size(); ++i) RC_ASSERT(ours[i].active == theirs[i].active);
  }

 private:
  std::int32_t coordinate(int side) { return static_cast<std::int32_t>(random_() % side) - side / 2; }

  void make(const std::string& id, decltype(Correction::what) what) {
    const Correction correction{people_.revision() + 1, id, "eva", 1, 1, std::move(what)};
    BrickSet touched;
    people_.apply(correction, touched);
    map_.mark(touched);
    stored_.push_back(correction);
  }
  std::string next_id() { return "id" + std::to_string(people_.revision() + 1); }

  /// A reset, a SLAM system that began anew, or one that comes back to a frame that was aligned before.
  void new_frame(const std::string& agent) {
    Naive::Agent& plain = naive_.agents[agent];
    plain = {"frame" + std::to_string(random_() % 2), 1 + static_cast<std::int64_t>(random_() % 2), {}};
    map_.begin_layer(agent, plain.frame_id, people_.weight(agent).value_or(1));
    const Transform* T = people_.T_map_agent(agent, plain.frame_id, plain.incarnation);
    if (T != nullptr) map_.place(agent, *T);
  }
  void remove(const std::string& agent) {
    naive_.agents.erase(agent);
    map_.remove_layer(agent);
  }
  void place(const std::string& agent) {
    const Naive::Agent& plain = naive_.agents.at(agent);
    const Transform T = random_() % 4 == 0 ? Transform::Identity() : random_transform(random_);
    naive_.placed[{agent, plain.frame_id, plain.incarnation}] = T;
    make(next_id(), Correction::Placement{agent, plain.frame_id, plain.incarnation, true, T});
    map_.place(agent, T);
  }
  void set_weight(const std::string& agent) {
    const int weight = 1 + static_cast<int>(random_() % 1000);
    naive_.weights[agent] = weight;
    make(next_id(), Correction::Weight{agent, weight});
    map_.set_weight(agent, weight);
  }
  void set_brick(const std::string& agent, Brick brick) {
    const BrickIndex index{coordinate(5), coordinate(5), coordinate(5)};
    naive_.agents.at(agent).map.set(index, brick);
    map_.set_brick(agent, index, std::move(brick));
  }
  void edit() {
    EditRequest request;
    request.id = next_id();
    request.author = "eva";
    request.op = static_cast<EditRequest::Op>(random_() % 3);
    request.move = {0.1 * coordinate(9), 0.1 * coordinate(9), 0};
    const VoxelIndex low{coordinate(30), coordinate(30), coordinate(30)};
    const auto side = [&] { return static_cast<std::int32_t>(random_() % 12); };
    request.shape = VoxelList{kResolution, {{low, {low.x + side(), low.y + side(), low.z + side()}}}};
    map_.refold();
    const auto edit = people_.check(request, Transform::Identity(), map_.map(), 1);
    if (!edit) return;
    naive_.edits.push_back({request.id, *edit, true});
    make(request.id, *edit);
  }
  void undo() {
    if (naive_.edits.empty()) return;
    Naive::Edit& edit = naive_.edits[random_() % naive_.edits.size()];
    const auto undo = people_.check(UndoRequest{next_id(), "eva", edit.id, !edit.active, 1}, 1);
    RC_ASSERT(undo.has_value());
    edit.active = !edit.active;
    make(next_id(), *undo);
  }
  void zone() {
    const std::string name = "zone" + std::to_string(random_() % 4);
    ZoneRequest request{next_id(), "eva", ZoneRequest::Op::kAdd, name, {}, Box{{0, 0, 0}, {1, 1, 1}}, {}, -1, 1};
    const bool there = std::ranges::find(naive_.zones, name) != naive_.zones.end();
    if (there) request.op = ZoneRequest::Op::kDelete;
    const auto change = people_.check(request, Transform::Identity(), 1);
    RC_ASSERT(change.has_value());
    if (there) std::erase(naive_.zones, name);
    if (!there) naive_.zones.push_back(name);
    make(request.id, *change);
  }

  std::mt19937 random_;
  Policy policy_;
  Naive naive_;
  People people_;
  LayeredMap map_;
  std::vector<Correction> stored_;
};

RC_GTEST_PROP(NoGhosts, TheMapIsAFreshMergeAfterEachOfAnySteps, (std::uint32_t seed)) {
  World world(seed);
  for (int step = 0; step < 40; ++step) {
    world.do_anything();
    world.check();
  }
  world.check_restart();
}

RC_GTEST_PROP(NoGhosts, TheMapIsAFreshMergeAfterManySteps, (std::uint32_t seed)) {
  World world(seed);
  for (int step = 0; step < 120; ++step) world.do_anything();
  world.check();
}

}  // namespace
}  // namespace concord
