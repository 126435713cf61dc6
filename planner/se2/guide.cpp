#include "planner/se2/guide.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace concord {
namespace {

constexpr std::size_t kYaws = 64;
constexpr double kYawStep = 2 * M_PI / kYaws;
/// A range of yaws narrower than this is a narrow place.
constexpr std::size_t kNarrow = kYaws / 4;
/// How far ahead and behind narrow places poses are added, in radii.
constexpr std::array kApproaches{0.5, 1.0, 1.5, 2.5};

Eigen::Vector2d centre_of(Cell cell) { return {cell.x + 0.5, cell.y + 0.5}; }

/// A range of yaws that have room, in steps of kYawStep; `first` < kYaws.
struct Range {
  std::size_t first, count;
};

std::vector<Range> ranges_at(const StandingRoom& room, const Eigen::Vector2d& p) {
  std::array<bool, kYaws> has_room{};
  for (std::size_t i = 0; i < kYaws; ++i) has_room[i] = room.stands({p, static_cast<double>(i) * kYawStep});
  const auto blocked = std::find(has_room.begin(), has_room.end(), false);
  if (blocked == has_room.end()) return {{0, kYaws}};
  const auto offset = static_cast<std::size_t>(blocked - has_room.begin());
  std::vector<Range> ranges;
  for (std::size_t i = 1; i <= kYaws; ++i) {
    const std::size_t at = (offset + i) % kYaws;
    if (!has_room[at]) continue;
    if (has_room[(at + kYaws - 1) % kYaws]) {
      ++ranges.back().count;
    } else {
      ranges.push_back({at, 1});
    }
  }
  return ranges;
}

class Builder {
 public:
  Builder(const StandingRoom& room, const std::vector<Cell>& cells, const GuideDensity& density)
      : room_(room), cells_(cells), density_(density), radius_(room.footprint().circumscribed()) {}

  Guide build(const Pose& start, const Pose& goal) {
    const auto last = static_cast<std::ptrdiff_t>(cells_.size()) - 1;
    const auto step = std::max<std::ptrdiff_t>(1, std::lround(radius_ * density_.spacing));
    const std::ptrdiff_t count = last / step;
    places_.clear();
    places_.push_back(0);
    for (std::ptrdiff_t i = 1; i <= count; ++i) places_.push_back(i * last / (count + 1));
    places_.push_back(last);
    guide_.stops.assign(places_.size(), {});
    for (std::size_t i = 0; i < places_.size(); ++i) add_stop(i);
    // Whoever starts or ends in a narrow place needs the way straight out of it.
    add_approaches(0, start);
    add_approaches(places_.size() - 1, goal);
    guide_.stops.insert(guide_.stops.begin(), {start});
    guide_.stops.push_back({goal});
    measure(start, goal);
    return std::move(guide_);
  }

 private:
  [[nodiscard]] double tangent(std::ptrdiff_t at) const {
    const auto around = std::max<std::ptrdiff_t>(1, std::lround(radius_ / 2));
    const auto last = static_cast<std::ptrdiff_t>(cells_.size()) - 1;
    const Cell a = cells_[static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, at - around))];
    const Cell b = cells_[static_cast<std::size_t>(std::min(last, at + around))];
    return std::atan2(b.y - a.y, b.x - a.x);
  }

  void add(std::size_t stop, const Pose& pose) {
    std::vector<Pose>& poses = guide_.stops[stop];
    constexpr double kSameYaw = 0.5 * kYawStep;
    const bool is_there = std::any_of(poses.begin(), poses.end(), [&](const Pose& other) {
      return (other.p - pose.p).norm() < 0.1 && std::abs(wrapped(other.yaw - pose.yaw)) < kSameYaw;
    });
    if (!is_there && room_.stands(pose)) poses.push_back(pose);
  }

  /// At a cell's centre; where nothing has room there, half a cell beside it.
  void add_stop(std::size_t stop) {
    const Eigen::Vector2d centre = centre_of(cells_[static_cast<std::size_t>(places_[stop])]);
    for (const Eigen::Vector2d& beside :
         {Eigen::Vector2d(0, 0), Eigen::Vector2d(0, 0.5), Eigen::Vector2d(0, -0.5), Eigen::Vector2d(0.5, 0),
          Eigen::Vector2d(-0.5, 0), Eigen::Vector2d(0.5, 0.5), Eigen::Vector2d(-0.5, -0.5)}) {
      const Eigen::Vector2d p = centre + beside;
      const std::vector<Range> ranges = ranges_at(room_, p);
      if (ranges.empty()) continue;
      for (const double yaw : {tangent(places_[stop]), wrapped(tangent(places_[stop]) + M_PI)}) add(stop, {p, yaw});
      for (int i = 0; i < density_.yaws; ++i) add(stop, {p, wrapped(2 * M_PI * i / density_.yaws)});
      for (const Range& range : ranges) add_range(stop, p, range);
      return;
    }
  }

  void add_range(std::size_t stop, const Eigen::Vector2d& p, const Range& range) {
    if (range.count == kYaws) return;
    const double middle = (static_cast<double>(range.first) + static_cast<double>(range.count - 1) / 2) * kYawStep;
    const Pose pose{p, wrapped(middle)};
    add(stop, pose);
    if (range.count < kNarrow) add_approaches(stop, pose);
  }

  void add_approaches(std::size_t stop, const Pose& narrow) {
    for (const double side : {1.0, -1.0}) {
      for (const double radii : kApproaches) {
        const Move move{side * radii * radius_, 0};
        if (!room_.moves(narrow, move)) break;
        const Pose pose = move.from(narrow);
        add(nearest(pose.p, stop), pose);
      }
    }
  }

  /// The stop nearest to `p`, of those around one.
  [[nodiscard]] std::size_t nearest(const Eigen::Vector2d& p, std::size_t around) const {
    const auto reach = static_cast<std::size_t>(4 / density_.spacing) + 1;
    std::size_t best = around;
    double least = 1e300;
    for (std::size_t i = around > reach ? around - reach : 0; i < std::min(places_.size(), around + reach + 1); ++i) {
      const double apart = (centre_of(cells_[static_cast<std::size_t>(places_[i])]) - p).squaredNorm();
      if (apart < least) {
        least = apart;
        best = i;
      }
    }
    return best;
  }

  void measure(const Pose& start, const Pose& goal) {
    guide_.left.assign(guide_.stops.size(), 0);
    for (std::size_t i = places_.size(); i-- > 0;) {
      const Eigen::Vector2d here = centre_of(cells_[static_cast<std::size_t>(places_[i])]);
      const Eigen::Vector2d next =
          i + 1 < places_.size() ? centre_of(cells_[static_cast<std::size_t>(places_[i + 1])]) : goal.p;
      guide_.left[i + 1] = guide_.left[i + 2] + (next - here).norm();
    }
    guide_.left[0] = guide_.left[1] + (centre_of(cells_.front()) - start.p).norm();
  }

  const StandingRoom& room_;
  const std::vector<Cell>& cells_;
  const GuideDensity& density_;
  double radius_;
  std::vector<std::ptrdiff_t> places_;  ///< by stop but the first and last
  Guide guide_;
};

}  // namespace

Guide make_guide(const StandingRoom& room, const std::vector<Cell>& cells, const Pose& start, const Pose& goal,
                 const GuideDensity& density) {
  return Builder(room, cells, density).build(start, goal);
}

}  // namespace concord
