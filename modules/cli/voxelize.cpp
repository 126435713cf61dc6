#include <memory>

#include <nlohmann/json.hpp>

#include "cli/arguments.hpp"
#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "cli/semantic_commands.hpp"
#include "cli/voxel_box.hpp"
#include "core/octomap_format.hpp"
#include "semantic/models/model_file.hpp"
#include "semantic/models/solid_voxels.hpp"

namespace concord {
namespace {

struct Options {
  std::string model, out;
  std::string transform = "0 0 0 0 0 0 1";
  double resolution = 0.05;
  double scale = 1.0;
  bool surface_only = false;
};

Outcome voxelize(const Options& options, const Common& common) {
  const auto T = parse_transform(options.transform);
  if (!T) return fail(T.error());
  if (const auto fine = checked_resolution(options.resolution); !fine) return fail(fine.error());
  const auto mesh = read_model_file(options.model);
  if (!mesh) return fail(mesh.error());
  const auto voxels =
      voxelize(*mesh, {*T, options.scale}, options.resolution, options.surface_only ? Fill::kSurface : Fill::kSolid);
  if (!voxels) return fail(voxels.error());
  BrickMasks all = voxels->surface;
  all.insert(voxels->interior);
  const BrickMap map = all.to_map(kOccupied);
  if (!options.out.empty()) {
    if (const auto saved = save_map(options.out, map, options.resolution); !saved) return fail(saved.error());
  }
  const std::int64_t surface = voxels->surface.count(), interior = voxels->interior.count();
  nlohmann::json object = {{"resolution", options.resolution},
                           {"triangles", mesh->triangles.size()},
                           {"watertight", voxels->watertight},
                           {"surface", surface},
                           {"interior", interior},
                           {"voxels", surface + interior},
                           {"digest", hex(digest(map))}};
  object["box"] = box_json(all, options.resolution);
  common.print(object, "triangles   " + format_count(static_cast<std::int64_t>(mesh->triangles.size())) +
                           (voxels->watertight ? ", watertight" : ", not watertight") + "\nsurface     " +
                           format_count(surface) + " voxels\ninterior    " + format_count(interior) + "\nbox         " +
                           box_words(all, options.resolution) +
                           (options.out.empty() ? "" : "\nwritten to  " + options.out));
  return Exit::kDone;
}

}  // namespace

void add_voxelize(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("voxelize", "the exact voxels of a CAD model: its surface and its inside",
                                  [options](const Common& common) { return voxelize(*options, common); });
  command.add_option("model", options->model, ".glb, .gltf, .obj, .stl or .ply")->required();
  command.add_option("--resolution", options->resolution, "edge of a voxel, metres")->capture_default_str();
  command.add_option("--transform", options->transform,
                     "T_map_model as \"x y z qx qy qz qw\"; without it the model's axes are the map's");
  command.add_option("--scale", options->scale, "metres per unit of the file: 0.001 for millimetres")
      ->check(CLI::Range(1e-9, 1e9));
  command.add_flag("--surface", options->surface_only, "leaves the inside out");
  command.add_option("--out", options->out, "writes the voxels: .bt or .ot");
}

}  // namespace concord
