// project, grid: a height band as a 2D grid, of a map file and of the running planner.

#include <memory>
#include <optional>

#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/grid_file.hpp"
#include "cli/live.hpp"
#include "cli/map_file.hpp"
#include "cli/numbers.hpp"

namespace concord {
namespace {

struct Options {
  std::string file, out;
  std::vector<double> band;
  std::optional<double> free_share;  ///< absent: the site's
};

/// Into `out` (none if it is empty), and in words.
Outcome save_and_print(const Grid& grid, const std::string& out, const Common& common) {
  const auto extent = extent_of(grid);
  if (!extent) return fail(extent.error());
  if (!out.empty()) {
    const auto saved = save_grid(out, grid, *extent);
    if (!saved) return fail(saved.error());
  }
  const double r = grid.resolution();
  const std::int64_t unknown = extent->width() * extent->height() - extent->free - extent->occupied;
  common.print({{"resolution", r},
                {"width", extent->width()},
                {"height", extent->height()},
                {"origin", {extent->min.x * r, extent->min.y * r}},
                {"free", extent->free},
                {"occupied", extent->occupied},
                {"unknown", unknown}},
               "grid      " + std::to_string(extent->width()) + " x " + std::to_string(extent->height()) +
                   " cells of " + format_number(r, 3) + " m\nfree      " + format_count(extent->free) + "\noccupied  " +
                   format_count(extent->occupied) + "\nunknown   " + format_count(unknown) +
                   (out.empty() ? "" : "\nwritten to " + out));
  return Exit::kDone;
}

Outcome project(const Options& options, const Common& common) {
  const auto loaded = load_map(options.file);
  if (!loaded) return fail(loaded.error());
  const auto grid = project_map(loaded->map, loaded->resolution, options.band[0], options.band[1],
                                options.free_share.value_or(common.site().planner.free_share));
  if (!grid) return fail(grid.error());
  return save_and_print(*grid, options.out, common);
}

/// The planner's, whose cells travel as voxels of one layer.
Outcome save_live(const std::string& out, const Common& common) {
  Live live(common);
  if (const auto taken = live.take_resolution(); !taken) return tl::unexpected(taken.error());
  StreamCopy cells(live, "out/grid");
  if (const auto synced = cells.wait_synced(live); !synced) return tl::unexpected(synced.error());
  const double r = live.site().resolution;
  const auto grid = project_map(cells.map(), r, 0, r, 1.0);
  if (!grid) return fail(grid.error());
  return save_and_print(*grid, out, common);
}

}  // namespace

void add_project(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("project", "a height band of a map file as a 2D grid",
                                  [options](const Common& common) { return project(*options, common); });
  command.add_option("file", options->file, ".bt or .ot")->required();
  command.add_option("--band", options->band, "zmin zmax, metres")->expected(2)->required();
  command
      .add_option("--free-share", options->free_share,
                  "of the band that must be observed free, above 0 to 1; without it the site's")
      ->check(CLI::Range(1e-6, 1.0));
  command.add_option("--out", options->out, "writes a .pgm, and the .yaml that map_server reads");

  auto out = std::make_shared<std::string>();
  program
      .add("grid", "the planner's grid as it is now", [out](const Common& common) { return save_live(*out, common); })
      .add_option("--out", *out, "writes a .pgm, and the .yaml that map_server reads");
}

}  // namespace concord
