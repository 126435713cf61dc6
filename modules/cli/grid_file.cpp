#include "cli/grid_file.hpp"

#include <sstream>

#include "cli/extension.hpp"
#include "cli/map_file.hpp"
#include "planner/files/map_server.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

constexpr std::int64_t kMaxCells = 100'000'000;

// What map_server's trinary mode makes free, unknown and occupied of.
constexpr std::uint8_t kFreeGrey = 254, kUnknownGrey = 205, kOccupiedGrey = 0;

std::uint8_t grey_of(LogOdds cell) {
  if (!is_known(cell)) return kUnknownGrey;
  return is_occupied(cell) ? kOccupiedGrey : kFreeGrey;
}

}  // namespace

Result<GridExtent> extent_of(const Grid& grid) {
  constexpr std::int32_t kFar = std::numeric_limits<std::int32_t>::max();
  GridExtent extent{{kFar, kFar}, {-kFar, -kFar}};
  grid.cells().for_each_brick([&](BrickIndex index, const Brick& brick) {
    brick.for_each([&](int local, LogOdds value) {
      const VoxelIndex v = voxel_at(index, local);
      extent.min = {std::min(extent.min.x, v.x), std::min(extent.min.y, v.y)};
      extent.max = {std::max(extent.max.x, v.x), std::max(extent.max.y, v.y)};
      ++(is_occupied(value) ? extent.occupied : extent.free);
    });
  });
  if (extent.occupied + extent.free == 0)
    return refuse(Code::kEmpty, "the map holds nothing in this band; give another --band");
  return extent;
}

Result<void> save_grid(const std::filesystem::path& pgm, const Grid& grid, const GridExtent& extent) {
  if (extension_of(pgm) != ".pgm") return refuse(Code::kBadName, pgm.string() + " must end in .pgm");
  if (extent.width() * extent.height() > kMaxCells) {
    return refuse(Code::kTooLarge, "the grid has " + std::to_string(extent.width()) + " x " +
                                       std::to_string(extent.height()) + " cells, over 100 million");
  }
  std::ostringstream picture;
  picture << "P5\n" << extent.width() << ' ' << extent.height() << "\n255\n";
  for (std::int32_t y = extent.max.y; y >= extent.min.y; --y) {
    for (std::int32_t x = extent.min.x; x <= extent.max.x; ++x)
      picture.put(static_cast<char>(grey_of(grid.at({x, y}))));
  }
  if (auto written = write_file(pgm, picture.str()); !written) return written;

  std::ostringstream yaml;
  yaml.precision(12);
  yaml << "image: " << pgm.filename().string() << "\nmode: trinary\nresolution: " << grid.resolution() << "\norigin: ["
       << extent.min.x * grid.resolution() << ", " << extent.min.y * grid.resolution()
       << ", 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  return write_file(std::filesystem::path(pgm).replace_extension(".yaml"), yaml.str());
}

Result<LoadedGrid> load_grid(const std::filesystem::path& yaml) {
  constexpr std::size_t kMaxYaml = 65'536;
  const auto text = read_whole_file(yaml, kMaxYaml);
  if (!text) return tl::unexpected(text.error());
  const auto info = read_map_server_yaml({reinterpret_cast<const char*>(text->data()), text->size()});
  if (!info) return refuse(info.error().code, yaml.string() + ": " + info.error().message);
  const std::filesystem::path pgm = yaml.parent_path() / info->image;
  const auto bytes = read_whole_file(pgm, kMaxPgmCells + 4096);
  if (!bytes) return tl::unexpected(bytes.error());
  auto cells = read_map_server_pgm(*info, *bytes);
  if (!cells) return refuse(cells.error().code, pgm.string() + ": " + cells.error().message);
  auto grid = project_map(*cells, info->resolution, 0, info->resolution, 1.0);
  if (!grid) return tl::unexpected(grid.error());
  return LoadedGrid{std::move(*grid), std::move(*cells), info->origin};
}

Result<Grid> project_map(const BrickMap& map, double resolution, double zmin, double zmax, double free_share) {
  const Result<Band> band = make_band(zmin, zmax, resolution);
  if (!band) return tl::unexpected(band.error());
  Grid grid(resolution, *band, free_share);
  grid.update(map, map.sorted_bricks());
  return grid;
}

}  // namespace concord
