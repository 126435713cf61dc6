#include "cli/plan_ground.hpp"

#include "cli/map_file.hpp"

namespace concord {

Result<Ground2D> ground_of_grid(const std::string& yaml) {
  auto loaded = load_grid(yaml);
  if (!loaded) return tl::unexpected(loaded.error());
  return Ground2D{std::move(loaded->grid), std::move(loaded->cells), loaded->origin};
}

Result<Ground2D> ground_of_map(const std::string& file, double zmin, double zmax, double free_share) {
  auto loaded = load_map(file);
  if (!loaded) return tl::unexpected(loaded.error());
  auto grid = project_map(loaded->map, loaded->resolution, zmin, zmax, free_share);
  if (!grid) return tl::unexpected(grid.error());
  return Ground2D{std::move(*grid), std::move(loaded->map)};
}

}  // namespace concord
