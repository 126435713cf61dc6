#include "planner/terrain.hpp"

namespace concord {

std::uint64_t Terrain::free_at(BrickIndex column) const {
  const Brick* cells = grid_->cells().find(column);
  const std::uint64_t free = free_plane(cells);
  switch (ignoring_) {
    case Ignoring::kNothing:
    case Ignoring::kRobots:
    case Ignoring::kNoGo: return free;
    case Ignoring::kPins: return free | grid_->pinned(column);
    case Ignoring::kUnobserved: {
      const std::uint64_t unknown = cells == nullptr ? ~std::uint64_t{0} : ~cells->known()[0];
      return free | (unknown & CellRectangle{grid_->seen().low, grid_->seen().high}.plane(column));
    }
  }
  return free;
}

Ground Terrain::at(BrickIndex column) const {
  const std::uint64_t free = free_at(column);
  const bool has_zones = zones_->has_no_go() || zones_->has_contact();
  if (!has_zones && robots_->empty()) return {free, free, free};
  std::uint64_t forbidden = ignoring_ == Ignoring::kNoGo ? 0 : zones_->no_go(column);
  if (ignoring_ != Ignoring::kRobots) forbidden |= robots_->at(column);
  const std::uint64_t passable = free & ~forbidden;
  return {free, passable, passable | (zones_->contact(column) & ~forbidden)};
}

}  // namespace concord
