#include <filesystem>
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
#include "semantic/segmentation/segment.hpp"

namespace concord {
namespace {

struct Options {
  std::string file, seed, out;
  std::string transform = "0 0 0 0 0 0 1";
  double resolution = 0.05;
};

struct Scene {
  BrickMasks occupied;
  double resolution = 0.0;
};

Result<Scene> load_scene(const Options& options) {
  const std::string extension = std::filesystem::path(options.file).extension();
  if (extension == ".bt" || extension == ".ot") {
    const auto map = load_map(options.file);
    if (!map) return tl::unexpected(map.error());
    return Scene{occupied_of(map->map), map->resolution};
  }
  const auto T = parse_transform(options.transform);
  if (!T) return tl::unexpected(T.error());
  if (const auto fine = checked_resolution(options.resolution); !fine) return tl::unexpected(fine.error());
  const auto mesh = read_model_file(options.file);
  if (!mesh && mesh.error().code == Code::kBadName) {
    return refuse(Code::kBadName, options.file + ": a map must be .bt or .ot, a mesh .glb, .gltf, .obj, .stl or .ply");
  }
  if (!mesh) return tl::unexpected(mesh.error());
  auto voxels = voxelize(*mesh, {*T, 1.0}, options.resolution, Fill::kSurface);
  if (!voxels) return tl::unexpected(voxels.error());
  return Scene{std::move(voxels->surface), options.resolution};
}

const char* name_of(Proposal::Kind kind) {
  switch (kind) {
    case Proposal::Kind::kFlatTopped: return "flat_topped";
    case Proposal::Kind::kUpright: return "upright";
    case Proposal::Kind::kCluster: break;
  }
  return "cluster";
}

Outcome segment(const Options& options, const Common& common) {
  const auto seed = parse_vector(options.seed);
  if (!seed) return fail(seed.error());
  const auto scene = load_scene(options);
  if (!scene) return fail(scene.error());
  const auto proposal = propose_object(scene->occupied, scene->resolution, *seed);
  if (!proposal) return fail(proposal.error());
  if (!options.out.empty()) {
    const auto saved = save_map(options.out, proposal->voxels.to_map(kOccupied), scene->resolution);
    if (!saved) return fail(saved.error());
  }
  const std::int64_t count = proposal->voxels.count();
  common.print({{"voxels", count},
                {"kind", name_of(proposal->kind)},
                {"resolution", scene->resolution},
                {"box", box_json(proposal->voxels, scene->resolution)}},
               format_count(count) + " voxels, " + name_of(proposal->kind) + "\n" +
                   box_words(proposal->voxels, scene->resolution) +
                   (options.out.empty() ? "" : "\nwritten to " + options.out));
  return Exit::kDone;
}

}  // namespace

void add_segment(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("segment", "proposes the voxels of the object at one place",
                                  [options](const Common& common) { return segment(*options, common); });
  command.add_option("file", options->file, "a scanned mesh (.ply, .obj, .glb, .gltf, .stl) or a map (.bt, .ot); z up")
      ->required();
  command.add_option("--seed", options->seed, "\"x y z\" on the object, metres")->required();
  command.add_option("--resolution", options->resolution, "edge of a voxel of a mesh, metres; a map has its own")
      ->capture_default_str();
  command.add_option("--transform", options->transform,
                     "T_map_mesh as \"x y z qx qy qz qw\", for a mesh that is not z up");
  command.add_option("--out", options->out, "writes the voxels: .bt or .ot");
}

}  // namespace concord
