#include "semantic/labels/keep_out.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "core/text.hpp"

namespace concord {
namespace {

constexpr int kSides = 32;
static_assert(kSides <= static_cast<int>(kMaxVolumePoints));
constexpr double kFirstCell = 2.0;  ///< metres: of things that share a zone

/// What lies inside of kSides lines, each as far out as a thing and its margin reach in that direction.
struct Outline {
  std::array<double, kSides> reach;
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  std::string name;
  int cost = 0;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();

  Outline() { reach.fill(std::numeric_limits<double>::lowest()); }
  void add(const Outline& other) {
    for (int i = 0; i < kSides; ++i) reach[i] = std::max(reach[i], other.reach[i]);
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
};

Eigen::Vector2d direction(int side) {
  const double angle = 2 * M_PI * side / kSides;
  return {std::cos(angle), std::sin(angle)};
}

Outline outline_of(const KeptClearOf& thing, double resolution) {
  Outline out;
  out.name = thing.name;
  out.cost = thing.cost;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const VoxelIndex v : thing.voxels) {
    const Eigen::Vector3d p = centre_of(v, resolution);
    sum += p.head<2>();
    out.low = std::min(out.low, p.z() - resolution / 2);
    out.high = std::max(out.high, p.z() + resolution / 2);
    for (int i = 0; i < kSides; ++i) out.reach[i] = std::max(out.reach[i], p.head<2>().dot(direction(i)));
  }
  for (int i = 0; i < kSides; ++i) {
    // To the corners of the cells, and on.
    out.reach[i] += direction(i).cwiseAbs().sum() * resolution / 2 + thing.margin;
  }
  out.middle = sum / static_cast<double>(thing.voxels.size());
  return out;
}

/// Where two neighbouring lines cross. Each touches what it bounds, so these are all corners and in their order; the
/// margin keeps them apart.
Eigen::Vector2d corner(const Outline& outline, int side) {
  const int next = (side + 1) % kSides;
  Eigen::Matrix2d lines;
  lines.row(0) = direction(side).transpose();
  lines.row(1) = direction(next).transpose();
  return lines.inverse() * Eigen::Vector2d(outline.reach[side], outline.reach[next]);
}

Zone zone_of(const Outline& outline) {
  Zone zone;
  zone.name = outline.name.substr(0, kMaxTitleBytes);
  while (!is_kept_title(zone.name)) zone.name.pop_back();  // not amidst a character
  zone.kind = outline.cost == 0 ? Zone::Kind::kNoGo : Zone::Kind::kCostly;
  zone.cost = outline.cost;
  Prism prism;
  for (int side = 0; side < kSides; ++side) prism.points.push_back(corner(outline, side));
  prism.low = outline.low;
  prism.high = outline.high;
  zone.volume = std::move(prism);
  return zone;
}

/// One outline for all of one cost that lie in one square of this side.
std::vector<Outline> shared(const std::vector<Outline>& all, double side) {
  std::map<std::array<std::int64_t, 3>, Outline> by_square;
  for (const Outline& one : all) {
    const auto place = [&](double c) { return static_cast<std::int64_t>(std::floor(c / side)); };
    const auto [it, is_new] = by_square.try_emplace({place(one.middle.x()), place(one.middle.y()), one.cost}, one);
    if (!is_new) it->second.add(one);
    if (!is_new && !it->second.name.ends_with("others")) it->second.name += " and others";
  }
  std::vector<Outline> out;
  for (auto& [square, outline] : by_square) out.push_back(std::move(outline));
  return out;
}

/// At most so many, which must be no fewer than there are costs.
std::vector<Outline> fewer(std::vector<Outline> all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<Outline> out = all;
  for (double side = kFirstCell; out.size() > most; side *= 2) out = shared(all, side);
  return out;
}

}  // namespace

std::vector<Zone> keep_out_zones(std::span<const KeptClearOf> things, double resolution, std::size_t most) {
  std::vector<Outline> closed, dear;
  for (const KeptClearOf& thing : things) (thing.cost == 0 ? closed : dear).push_back(outline_of(thing, resolution));
  // What only costs shares first: a hull around several things would close the ways between them.
  closed = fewer(std::move(closed), most - std::min<std::size_t>(dear.size(), Zone::kMaxCost));
  dear = fewer(std::move(dear), most - closed.size());
  closed.insert(closed.end(), dear.begin(), dear.end());
  std::vector<Zone> out;
  for (const Outline& outline : closed) out.push_back(zone_of(outline));
  std::stable_sort(out.begin(), out.end(), [](const Zone& a, const Zone& b) { return a.name < b.name; });
  return out;
}

}  // namespace concord
