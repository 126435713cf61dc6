#include "cli/selection_options.hpp"

#include "cli/arguments.hpp"
#include "cli/voxel_file.hpp"
#include "core/requests.hpp"

namespace concord {
namespace {

/// The group in which at most one shape is given: which must be, depends on the command.
CLI::App& add_volumes(CLI::App& command, SelectionOptions& options, const char* what) {
  auto* shape = command.add_option_group("selection", what);
  shape->add_option("--box", options.box, "\"x0 y0 z0 x1 y1 z1\": two opposite corners");
  shape->add_option("--oriented-box", options.oriented_box,
                    "\"x y z qx qy qz qw sx sy sz\": centre, rotation and whole edges");
  shape->add_option("--prism", options.prism, "\"x y x y x y ...\": a polygon from above, with --from and --to");
  shape->require_option(0, 1);
  command.add_option("--from", options.low, "z of the prism's floor, metres");
  command.add_option("--to", options.high, "z of the prism's top, metres");
  command.add_option("--frame", options.frame.agent, "the agent in whose frame it is drawn; without it the map's");
  command.add_option("--frame-id", options.frame.frame_id,
                     "that agent's frame as it was seen: refused if it has begun another since");
  return *shape;
}

Result<void> check_frame(const WorkFrame& frame) {
  for (const std::string& name : {frame.agent, frame.frame_id}) {
    if (name.empty() || is_name(name)) continue;
    return refuse(Code::kBadName, "'" + name + "' names no agent and no frame");
  }
  if (frame.agent.empty() && !frame.frame_id.empty()) {
    return refuse(Code::kBadRequest, "--frame-id goes with --frame AGENT");
  }
  return {};
}

Result<Prism> prism_of(const SelectionOptions& options) {
  if (!options.low || !options.high)
    return refuse(Code::kBadRequest, "--prism needs --from and --to, its lowest and highest z");
  return parse_points_2d(options.prism).map([&](std::vector<Eigen::Vector2d> points) {
    return Prism{std::move(points), *options.low, *options.high};
  });
}

Result<Volume> parse_volume(const SelectionOptions& options) {
  const auto as_volume = [](auto volume) { return Volume(std::move(volume)); };
  if (!options.box.empty()) return parse_box(options.box).map(as_volume);
  if (!options.oriented_box.empty()) return parse_oriented_box(options.oriented_box).map(as_volume);
  if (!options.prism.empty()) return prism_of(options).map(as_volume);
  return refuse(Code::kBadRequest, "say where: --box, --oriented-box or --prism");
}

Result<Shape> parse_shape(const SelectionOptions& options, double resolution) {
  if (!options.line.empty()) {
    return parse_points(options.line).map([&](auto points) {
      return Shape(Line{std::move(points), options.thickness});
    });
  }
  if (!options.area.empty()) {
    return parse_points(options.area).map([&](auto points) {
      return Shape(Area{std::move(points), options.thickness});
    });
  }
  if (!options.voxels.empty()) {
    return read_voxels(options.voxels, resolution).map([](VoxelList list) { return Shape(std::move(list)); });
  }
  if (!is_given(options)) {
    return refuse(Code::kBadRequest, "say where: --line, --area, --box, --oriented-box, --prism or --voxels");
  }
  return parse_volume(options).map(
      [](Volume volume) { return std::visit([](auto& shape) { return Shape(std::move(shape)); }, volume); });
}

/// What was given that the chosen shape does not have would be passed over without a word.
Result<void> check_extras(const SelectionOptions& options) {
  if (options.prism.empty() && (options.low || options.high)) {
    return refuse(Code::kBadRequest, "--from and --to go with --prism");
  }
  if (options.thickness != 0.0 && options.line.empty() && options.area.empty()) {
    return refuse(Code::kBadRequest, "--thickness goes with --line or --area");
  }
  return check_frame(options.frame);
}

template <class Drawn>
Result<Drawn> checked(Result<Drawn> drawn) {
  if (!drawn) return drawn;
  if (const auto fine = check(*drawn); !fine) return tl::unexpected(fine.error());
  return drawn;
}

}  // namespace

void add_shape_options(CLI::App& command, SelectionOptions& options) {
  CLI::App& shape = add_volumes(command, options, "what is pinned: every voxel that it touches or shares volume with");
  shape.add_option("--line", options.line, "\"x y z x y z ...\"");
  shape.add_option("--area", options.area, "\"x y z x y z ...\": a polygon");
  shape.add_option("--voxels", options.voxels, "a file with three indices a line, map lattice");
  command.add_option("--thickness", options.thickness, "of a line or area: voxels within half of it are pinned too");
}

void add_volume_options(CLI::App& command, SelectionOptions& options) {
  add_volumes(command, options, "the volume, metres");
}

bool is_given(const SelectionOptions& options) {
  for (const std::string* shape :
       {&options.line, &options.area, &options.box, &options.oriented_box, &options.prism, &options.voxels}) {
    if (!shape->empty()) return true;
  }
  return false;
}

Result<Shape> shape_of(const SelectionOptions& options, double resolution) {
  return check_extras(options).and_then([&] { return checked(parse_shape(options, resolution)); });
}

Result<Volume> volume_of(const SelectionOptions& options) {
  return check_extras(options).and_then([&] { return checked(parse_volume(options)); });
}

}  // namespace concord
