#include <memory>

#include <nlohmann/json.hpp>

#include "cli/archive_info.hpp"
#include "cli/command.hpp"
#include "cli/extension.hpp"
#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "store/whole_file.hpp"

namespace concord {
namespace {

struct Bounds {
  VoxelIndex min{kMaxVoxel, kMaxVoxel, kMaxVoxel};
  VoxelIndex max{-kMaxVoxel, -kMaxVoxel, -kMaxVoxel};
};

Bounds bounds_of(const BrickMap& map) {
  Bounds bounds;
  map.for_each_brick([&](BrickIndex index, const Brick& brick) {
    brick.for_each([&](int local, LogOdds) {
      const VoxelIndex v = voxel_at(index, local);
      bounds.min = {std::min(bounds.min.x, v.x), std::min(bounds.min.y, v.y), std::min(bounds.min.z, v.z)};
      bounds.max = {std::max(bounds.max.x, v.x), std::max(bounds.max.y, v.y), std::max(bounds.max.z, v.z)};
    });
  });
  return bounds;
}

Outcome info_archive(const std::string& file, const Common& common) {
  const auto bytes = read_whole_file(file, kMaxArchiveBytes);
  if (!bytes) return fail(bytes.error());
  const auto archive = read_map_archive(*bytes);
  if (!archive) return fail({archive.error().code, file + ": " + archive.error().message});
  common.print(to_json(*archive), to_words(*archive));
  return Exit::kDone;
}

Outcome info(const std::string& file, const Common& common) {
  if (extension_of(file) == ".concord") return info_archive(file, common);
  const auto loaded = load_map(file);
  if (!loaded) return fail(loaded.error());
  const BrickMap& map = loaded->map;
  const double r = loaded->resolution;
  const std::size_t known = map.known_count(), occupied = map.occupied_count();
  nlohmann::json object = {{"resolution", r},
                           {"known", known},
                           {"occupied", occupied},
                           {"free", known - occupied},
                           {"bricks", map.brick_count()},
                           {"bounds", nullptr}};
  std::string words = "resolution  " + format_number(r, 4) + " m\nknown       " +
                      format_count(static_cast<std::int64_t>(known)) + " voxels\noccupied    " +
                      format_count(static_cast<std::int64_t>(occupied)) + "\nfree        " +
                      format_count(static_cast<std::int64_t>(known - occupied)) + "\nbricks      " +
                      format_count(static_cast<std::int64_t>(map.brick_count()));
  if (!map.empty()) {
    const Bounds b = bounds_of(map);
    const std::array<double, 3> low = {b.min.x * r, b.min.y * r, b.min.z * r};
    const std::array<double, 3> high = {(b.max.x + 1) * r, (b.max.y + 1) * r, (b.max.z + 1) * r};
    object["bounds"] = {{"min", low}, {"max", high}};
    for (std::size_t i = 0; i < 3; ++i) {
      words += "\n" + std::string(1, "xyz"[i]) + "           " + format_number(low[i], 2) + " to " +
               format_number(high[i], 2) + " m";
    }
  }
  common.print(object, words);
  return Exit::kDone;
}

}  // namespace

void add_info(Program& program) {
  auto file = std::make_shared<std::string>();
  program.add("info", "what a map file holds", [file](const Common& common) { return info(*file, common); })
      .add_option("file", *file, ".bt, .ot or .concord")
      ->required();
}

}  // namespace concord
