#include "planner/se2/guided_search.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <queue>

namespace concord {
namespace {

/// To stops so many ahead does a pose lead.
constexpr std::array<std::size_t, 12> kJumps{0, 1, 2, 3, 4, 6, 8, 11, 15, 20, 26, 34};

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

class AlongGuide {
 public:
  AlongGuide(const Guide& guide, const StandingRoom& room, const Steering& steering, const MotionCost& cost)
      : guide_(guide), room_(room), steering_(steering), cost_(cost) {
    for (std::size_t stop = 0; stop < guide.stops.size(); ++stop) {
      first_.push_back(static_cast<std::uint32_t>(nodes_.size()));
      for (const Pose& pose : guide.stops[stop]) nodes_.push_back({pose, stop});
    }
    first_.push_back(static_cast<std::uint32_t>(nodes_.size()));
  }

  FoundMotions find(const SearchEffort& effort) {
    FoundMotions found;
    const auto goal = static_cast<std::uint32_t>(nodes_.size()) - 1;
    open_.push({guide_.left.front(), 0, 0, kNone, order_++});
    while (!open_.empty() && found.steps < effort.most) {
      if (effort.stop()) {
        found.stopped = true;
        return found;
      }
      const Entry entry = open_.top();
      open_.pop();
      Node& node = nodes_[entry.node];
      if (node.is_done) continue;
      ++found.steps;
      if (entry.parent != kNone && !is_free(entry.parent, entry.node)) continue;
      node.is_done = true;
      node.parent = entry.parent;
      if (entry.node == goal) {
        found.motions = trace(goal);
        return found;
      }
      expand(entry.node, entry.cost);
    }
    return found;
  }

 private:
  struct Node {
    Pose pose;
    std::size_t stop;
    std::uint32_t parent = kNone;
    bool is_done = false;
  };
  struct Entry {
    double total, cost;
    std::uint32_t node, parent;
    std::uint64_t order;
    bool operator<(const Entry& other) const {
      return total != other.total ? total > other.total : order > other.order;
    }
  };

  [[nodiscard]] bool is_free(std::uint32_t from, std::uint32_t to) const {
    return has_room(room_, *steering_.connect(nodes_[from].pose, nodes_[to].pose));
  }

  void expand(std::uint32_t node, double cost) {
    const std::size_t stop = nodes_[node].stop;
    const std::size_t last = guide_.stops.size() - 1;
    for (const std::size_t jump : kJumps) {
      if (stop + jump < last) reach_stop(node, stop + jump, cost);
    }
    if (stop > 0) reach_stop(node, stop - 1, cost);
    reach_stop(node, last, cost);
  }

  void reach_stop(std::uint32_t node, std::size_t stop, double cost) {
    for (std::uint32_t to = first_[stop]; to < first_[stop + 1]; ++to) {
      if (nodes_[to].is_done) continue;
      const auto motion = steering_.connect(nodes_[node].pose, nodes_[to].pose);
      if (!motion) continue;
      const double total = cost + cost_(*motion);
      open_.push({total + guide_.left[stop], total, to, node, order_++});
    }
  }

  [[nodiscard]] std::vector<Motion> trace(std::uint32_t node) const {
    std::vector<Motion> motions;
    for (; nodes_[node].parent != kNone; node = nodes_[node].parent) {
      motions.push_back(*steering_.connect(nodes_[nodes_[node].parent].pose, nodes_[node].pose));
    }
    std::reverse(motions.begin(), motions.end());
    return motions;
  }

  const Guide& guide_;
  const StandingRoom& room_;
  const Steering& steering_;
  const MotionCost& cost_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> first_;  ///< by stop, and one more
  std::priority_queue<Entry> open_;
  std::uint64_t order_ = 0;
};

}  // namespace

FoundMotions search_along(const Guide& guide, const StandingRoom& room, const Steering& steering,
                          const MotionCost& cost, const SearchEffort& effort) {
  return AlongGuide(guide, room, steering, cost).find(effort);
}

}  // namespace concord
