#include "semantic/labels/keep_out.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/text.hpp"

namespace concord {
namespace {

constexpr int kSides = Outline::kSides;
static_assert(kSides <= static_cast<int>(kMaxVolumePoints));
constexpr double kFirstCell = 2.0;  ///< metres: of things that share a zone

/// What lies inside of kSides lines, each as far out as a thing and its margin reach in that direction.
struct Hull {
  std::array<double, kSides> reach{};
  double low = 0, high = 0;
  std::string name;
  int cost = 0;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();

  void add(const Hull& other) {
    for (std::size_t i = 0; i < reach.size(); ++i) reach[i] = std::max(reach[i], other.reach[i]);
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
};

Hull hull_of(const KeptClearOf& thing, double resolution) {
  const Outline& outline = thing.outline;
  Hull out;
  out.name = thing.name;
  out.cost = thing.cost;
  out.low = outline.lowest * resolution;
  out.high = (outline.highest + 1.0) * resolution;
  const auto mean = [&](std::int64_t sum) {
    return (static_cast<double>(sum) / static_cast<double>(outline.count) + 0.5) * resolution;
  };
  out.middle = {mean(outline.sum_x), mean(outline.sum_y)};
  for (std::size_t i = 0; i < out.reach.size(); ++i) {
    // To the corners of the cells, and on.
    const double to_corner = outline_directions()[i].cwiseAbs().sum() * resolution / 2;
    out.reach[i] = outline.reach[i] + to_corner + thing.margin;
  }
  return out;
}

/// Where two neighbouring lines cross. Each touches what it bounds, so these are all corners and in their order; the
/// margin keeps them apart.
Eigen::Vector2d corner(const Hull& hull, std::size_t side) {
  const std::size_t next = (side + 1) % kSides;
  Eigen::Matrix2d lines;
  lines.row(0) = outline_directions()[side].transpose();
  lines.row(1) = outline_directions()[next].transpose();
  return lines.inverse() * Eigen::Vector2d(hull.reach[side], hull.reach[next]);
}

Zone zone_of(const Hull& hull) {
  Zone zone;
  zone.name = hull.name.substr(0, kMaxTitleBytes);
  while (!is_kept_title(zone.name)) zone.name.pop_back();  // not amidst a character
  zone.kind = hull.cost == 0 ? Zone::Kind::kNoGo : Zone::Kind::kCostly;
  zone.cost = hull.cost;
  Prism prism;
  for (std::size_t side = 0; side < kSides; ++side) prism.points.push_back(corner(hull, side));
  prism.low = hull.low;
  prism.high = hull.high;
  zone.volume = std::move(prism);
  return zone;
}

/// One hull for all of one cost that lie in one square of this side.
std::vector<Hull> shared(const std::vector<Hull>& all, double side) {
  std::map<std::array<std::int64_t, 3>, Hull> by_square;
  for (const Hull& one : all) {
    const auto place = [&](double c) { return static_cast<std::int64_t>(std::floor(c / side)); };
    const auto [it, is_new] = by_square.try_emplace({place(one.middle.x()), place(one.middle.y()), one.cost}, one);
    if (!is_new) it->second.add(one);
    if (!is_new && !it->second.name.ends_with("others")) it->second.name += " and others";
  }
  std::vector<Hull> out;
  for (auto& [square, hull] : by_square) out.push_back(std::move(hull));
  return out;
}

/// At most so many, which must be no fewer than there are costs.
std::vector<Hull> fewer(std::vector<Hull> all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<Hull> out = all;
  for (double side = kFirstCell; out.size() > most; side *= 2) out = shared(all, side);
  return out;
}

}  // namespace

std::vector<Zone> keep_out_zones(std::span<const KeptClearOf> things, double resolution, std::size_t most) {
  std::vector<Hull> closed, dear;
  for (const KeptClearOf& thing : things) (thing.cost == 0 ? closed : dear).push_back(hull_of(thing, resolution));
  // What only costs shares first: a hull around several things would close the ways between them.
  closed = fewer(std::move(closed), most - std::min<std::size_t>(dear.size(), Zone::kMaxCost));
  dear = fewer(std::move(dear), most - closed.size());
  closed.insert(closed.end(), dear.begin(), dear.end());
  std::vector<Zone> out;
  for (const Hull& hull : closed) out.push_back(zone_of(hull));
  std::stable_sort(out.begin(), out.end(), [](const Zone& a, const Zone& b) { return a.name < b.name; });
  return out;
}

}  // namespace concord
