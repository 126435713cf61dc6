#include "planner/se2/shorten_motions.hpp"

#include <algorithm>
#include <cmath>

namespace concord {
namespace {

constexpr int kPasses = 3;
/// What must be gained, of what a stretch costs.
constexpr double kGain = 0.002;

/// Single moves, the long ones in parts, so that there are poses to join between.
void append_parts(const Motion& motion, double length, std::vector<Motion>& parts) {
  for_each_move(motion, [&](const Pose& at, const Move& move) {
    const int count = 1 + static_cast<int>(std::abs(move.travel) / length);
    for (int i = 0; i < count; ++i) {
      Motion part{move.from(at, static_cast<double>(i) / count), move.from(at, (i + 1.0) / count), {}, 1};
      part.moves[0] = {move.travel / count, move.turn / count};
      parts.push_back(part);
    }
    return true;
  });
  if (!parts.empty()) parts.back().to = motion.to;
}

class Shortener {
 public:
  Shortener(const std::vector<Motion>& motions, const StandingRoom& room, const Steering& steering,
            const MotionCost& cost)
      : room_(room), steering_(steering), cost_(cost), part_length_(room.footprint().circumscribed()) {
    for (const Motion& motion : motions) append_parts(motion, part_length_, parts_);
  }

  FoundMotions run(const SearchEffort& effort) {
    FoundMotions found;
    for (int pass = 0; pass < kPasses && !found.stopped; ++pass) {
      bool gained = false;
      measure();
      for (std::size_t i = 0; i < parts_.size() && found.steps < effort.most; ++i) {
        found.stopped = effort.stop();
        if (found.stopped) break;
        gained = jump_from(i, found.steps) || gained;
      }
      if (!gained) break;
    }
    found.motions = parts_;
    return found;
  }

 private:
  void measure() {
    costs_.clear();
    for (const Motion& part : parts_) costs_.push_back(cost_(part));
    // A change of direction between two parts costs, too.
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      if (parts_[i - 1].moves[0].travel * parts_[i].moves[0].travel < 0)
        costs_[i] += MotionCost::kChange * room_.footprint().circumscribed();
    }
  }

  /// From the pose before part i to one as far on as can be.
  bool jump_from(std::size_t i, std::int64_t& steps) {
    std::vector<double> sums{0};
    for (std::size_t k = i; k < parts_.size(); ++k) sums.push_back(sums.back() + costs_[k]);
    for (std::size_t count = parts_.size() - i; count >= 2; count = count > 8 ? count * 3 / 4 : count - 1) {
      ++steps;
      const auto motion = steering_.connect(parts_[i].from, parts_[i + count - 1].to);
      if (!motion || motion->length() > sums[count] || cost_(*motion) > sums[count] * (1 - kGain)) continue;
      if (!has_room(room_, *motion)) continue;
      replace(i, count, *motion);
      return true;
    }
    return false;
  }

  void replace(std::size_t i, std::size_t count, const Motion& motion) {
    std::vector<Motion> parts;
    append_parts(motion, part_length_, parts);
    const auto at = [](auto& from, std::size_t k) { return from.begin() + static_cast<std::ptrdiff_t>(k); };
    parts_.erase(at(parts_, i), at(parts_, i + count));
    parts_.insert(at(parts_, i), parts.begin(), parts.end());
    measure();
  }

  const StandingRoom& room_;
  const Steering& steering_;
  const MotionCost& cost_;
  double part_length_;
  std::vector<Motion> parts_;
  std::vector<double> costs_;  ///< by part
};

}  // namespace

FoundMotions shorten(const std::vector<Motion>& motions, const StandingRoom& room, const Steering& steering,
                     const MotionCost& cost, const SearchEffort& effort) {
  return Shortener(motions, room, steering, cost).run(effort);
}

}  // namespace concord
