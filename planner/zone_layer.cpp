#include "planner/zone_layer.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace concord {

void ZoneLayer::Dirty::add(const Drawn& drawn) {
  for (const ColumnPlane& plane : drawn.cells.columns) columns.push_back(plane.column);
  anywhere |= !drawn.is(Zone::Kind::kAllowContact) && !drawn.is_fine;
}

/// Not drawn yet: what is drawn is paid for when it is known to be heeded.
ZoneLayer::Drawn ZoneLayer::counted(Zone zone) const {
  Drawn now;
  if (const auto cells = count(zone, resolution_, band_, kMaxZoneCells)) {
    now.fits = true;
    now.count = *cells;
  }
  now.zone = std::move(zone);
  return now;
}

/// The new list, by name, with what is still right of the old one moved over. Names come once; if one comes twice all
/// the same, both zones hold.
std::vector<ZoneLayer::Drawn> ZoneLayer::match(std::vector<Zone> zones, Dirty& dirty) {
  std::stable_sort(zones.begin(), zones.end(), [](const Zone& a, const Zone& b) { return a.name < b.name; });
  std::vector<Drawn> next;
  next.reserve(zones.size());
  auto old = zones_.begin();
  for (Zone& zone : zones) {
    for (; old != zones_.end() && old->zone.name < zone.name; ++old) dirty.add(*old);
    const bool was_there = old != zones_.end() && old->zone.name == zone.name;
    if (was_there && same_ground(old->zone, zone)) {
      next.push_back(std::move(*old++));
      continue;
    }
    if (was_there) dirty.add(*old++);
    next.push_back(counted(std::move(zone)));
  }
  for (; old != zones_.end(); ++old) dirty.add(*old);
  return next;
}

/// Takes the zone cell by cell if it has no more than `left`, from which they go off.
void ZoneLayer::settle(Drawn& zone, std::int64_t& left, Dirty& dirty) const {
  const bool is_fine = zone.fits && zone.count <= left;
  if (is_fine) left -= zone.count;
  if (zone.is_settled && is_fine == zone.is_fine) return;
  if (zone.is_settled) dirty.add(zone);
  auto cells = is_fine ? draw(zone.zone, resolution_, band_, zone.count) : Result<ZoneCells>();
  zone.is_settled = true;
  zone.is_fine = is_fine && cells;
  zone.cells = zone.is_fine ? std::move(*cells) : ZoneCells();
  if (!zone.is_fine) zone.around = rectangle_around(zone.zone, resolution_, band_);
  dirty.add(zone);
}

ZoneLayer::Change ZoneLayer::set(std::span<const Zone> zones) {
  Dirty dirty;
  zones_ = match({zones.begin(), zones.end()}, dirty);
  std::int64_t left = kMaxCells;
  rectangles_.clear();
  large_.clear();
  const bool had_corridors = has_corridors_;
  has_no_go_ = has_contact_ = has_costly_ = has_corridors_ = false;
  for (Drawn& zone : zones_) {
    settle(zone, left, dirty);
    has_no_go_ |= zone.is_no_go();
    has_contact_ |= zone.is(Zone::Kind::kAllowContact);
    has_costly_ |= zone.is(Zone::Kind::kCostly);
    has_corridors_ |= zone.is(Zone::Kind::kCorridor) && zone.has_cells();  // others are of another storey
    if (zone.is_fine || zone.is(Zone::Kind::kAllowContact)) continue;
    zone.is_no_go() ? rectangles_.push_back(zone.around) : large_.push_back(zone);
  }
  // All that lies beside them.
  dirty.anywhere |= had_corridors != has_corridors_;
  return {recompute(std::move(dirty.columns)), dirty.anywhere};
}

/// The dearest counts.
void ZoneLayer::Price::add(const Drawn& zone, BrickIndex column) {
  if (zone.is(Zone::Kind::kCorridor)) corridor |= zone.plane(column);
  if (!zone.is(Zone::Kind::kCostly)) return;
  for (std::uint64_t cells = zone.plane(column); cells != 0; cells &= cells - 1) {
    std::uint8_t& cost = costly[static_cast<std::size_t>(std::countr_zero(cells))];
    cost = std::max(cost, static_cast<std::uint8_t>(zone.zone.cost));
  }
}

/// Adds to the change where cells cost more or less than before.
void ZoneLayer::take_prices(const std::vector<const Drawn*>& near, ColumnChange& change) {
  Price now;
  for (const Drawn* zone : near) now.add(*zone, change.column);
  const auto it = prices_.find(change.column);
  const Price was = it != prices_.end() ? it->second : Price{};
  if (now == was) return;
  for (int local = 0; local < 64; ++local) {
    const int more = int{now.at(local, has_corridors_)} - was.at(local, has_corridors_);
    if (more > 0) change.blocked |= std::uint64_t{1} << local;
    if (more < 0) change.freed |= std::uint64_t{1} << local;
  }
  if (now == Price{}) {
    prices_.erase(change.column);
  } else {
    prices_[change.column] = now;
  }
}

ColumnCosts ZoneLayer::costs(BrickIndex column) const {
  ColumnCosts costs{};
  if (!has_costs()) return costs;
  Price price;
  if (const auto it = prices_.find(column); it != prices_.end()) price = it->second;
  for (const Drawn& zone : large_) price.add(zone, column);
  for (int local = 0; local < 64; ++local) costs[static_cast<std::size_t>(local)] = price.at(local, has_corridors_);
  return costs;
}

std::vector<ColumnChange> ZoneLayer::recompute(std::vector<BrickIndex> dirty) {
  std::sort(dirty.begin(), dirty.end());
  dirty.erase(std::unique(dirty.begin(), dirty.end()), dirty.end());
  CellRectangle around{{kMaxVoxel, kMaxVoxel}, {-kMaxVoxel, -kMaxVoxel}};
  for (const BrickIndex column : dirty) {
    around.low = {std::min(around.low.x, column.x * 8), std::min(around.low.y, column.y * 8)};
    around.high = {std::max(around.high.x, column.x * 8 + 7), std::max(around.high.y, column.y * 8 + 7)};
  }
  std::vector<const Drawn*> near;
  for (const Drawn& zone : zones_) {
    if (zone.is_fine && zone.cells.bounds.meets(around)) near.push_back(&zone);
  }
  std::vector<ColumnChange> changes;
  for (const BrickIndex column : dirty) {
    Planes now;
    for (const Drawn* zone : near) {
      if (zone->cells.bounds.plane(column) == 0) continue;
      if (zone->is_no_go()) now.no_go |= zone->cells.plane(column);
      if (zone->is(Zone::Kind::kAllowContact)) now.contact |= zone->cells.plane(column);
    }
    Planes was;
    if (const auto it = planes_.find(column); it != planes_.end()) {
      was = std::exchange(it->second, now);
      if ((now.no_go | now.contact) == 0) planes_.erase(it);
    } else if ((now.no_go | now.contact) != 0) {
      planes_.emplace(column, now);
    }
    const std::uint64_t was_open = was.contact & ~was.no_go;
    const std::uint64_t is_open = now.contact & ~now.no_go;
    ColumnChange change{column, (now.no_go & ~was.no_go) | (was_open & ~is_open),
                        (was.no_go & ~now.no_go) | (is_open & ~was_open)};
    take_prices(near, change);
    if ((change.blocked | change.freed) != 0) changes.push_back(change);
  }
  return changes;
}

std::uint64_t ZoneLayer::no_go(BrickIndex column) const {
  const auto it = planes_.find(column);
  std::uint64_t cells = it != planes_.end() ? it->second.no_go : 0;
  for (const CellRectangle& rectangle : rectangles_) cells |= rectangle.plane(column);
  return cells;
}

std::uint64_t ZoneLayer::contact(BrickIndex column) const {
  const auto it = planes_.find(column);
  return it != planes_.end() ? it->second.contact : 0;
}

const std::string* ZoneLayer::no_go_at(Cell cell) const {
  const BrickIndex column{cell.x >> 3, cell.y >> 3, 0};
  const std::uint64_t bit = std::uint64_t{1} << local_of(VoxelIndex{cell.x, cell.y, 0});
  const auto it = std::find_if(zones_.begin(), zones_.end(), [&](const Drawn& zone) {
    if (!zone.is_no_go()) return false;
    if (!zone.is_fine) return zone.around.holds(cell);
    return zone.cells.bounds.holds(cell) && (zone.cells.plane(column) & bit) != 0;
  });
  return it != zones_.end() ? &it->zone.name : nullptr;
}

std::vector<std::string> ZoneLayer::no_go_names(BrickIndex column) const {
  std::vector<std::string> names;
  for (const Drawn& zone : zones_) {
    if (!zone.is_no_go()) continue;
    const std::uint64_t cells = zone.is_fine ? zone.cells.bounds.plane(column) : zone.around.plane(column);
    if (cells != 0 && (!zone.is_fine || zone.cells.plane(column) != 0)) names.push_back(zone.zone.name);
  }
  return names;
}

std::optional<ZoneLayer::Near> ZoneLayer::nearest_no_go(const Eigen::Vector2d& p, double reach) const {
  if (!has_no_go_) return std::nullopt;
  const auto brick = [](double cells) { return static_cast<std::int32_t>(std::floor(cells / kBrickSide)); };
  double least = reach;
  std::optional<Cell> nearest;
  for (std::int32_t y = brick(p.y() - reach); y <= brick(p.y() + reach); ++y) {
    for (std::int32_t x = brick(p.x() - reach); x <= brick(p.x() + reach); ++x) {
      for (std::uint64_t bits = no_go({x, y, 0}); bits != 0; bits &= bits - 1) {
        const int local = std::countr_zero(bits);
        const Eigen::Vector2d low(8 * x + (local & 7), 8 * y + (local >> 3));
        const double distance = (p - p.cwiseMax(low).cwiseMin(low + Eigen::Vector2d::Ones())).norm();
        if (distance > least || (nearest && distance == least)) continue;
        least = distance;
        nearest = {8 * x + (local & 7), 8 * y + (local >> 3)};
      }
    }
  }
  if (!nearest) return std::nullopt;
  return Near{*no_go_at(*nearest), least};
}

std::vector<std::string> ZoneLayer::coarse() const {
  std::vector<std::string> names;
  for (const Drawn& zone : zones_) {
    if (!zone.is_fine) names.push_back(zone.zone.name);
  }
  return names;
}

const ZoneLayer& no_zones() {
  static const auto& none = *new ZoneLayer;
  return none;
}

}  // namespace concord
