#include <cstdint>
#include <fstream>
#include <memory>
#include <sstream>

#include <nlohmann/json.hpp>

#include "cli/arguments.hpp"
#include "cli/live.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "core/shape.hpp"
#include "core/voxel_boxes.hpp"

namespace concord {
namespace {

struct Options {
  std::string op, box, line, area, file, author;
  double thickness = 0.0;
};

/// One voxel: three whole numbers and nothing else. Absent where the line holds anything else.
std::optional<VoxelIndex> parse_voxel(const std::string& line) {
  std::istringstream in(line);
  VoxelIndex v;
  std::string more;
  if (!(in >> v.x >> v.y >> v.z) || in >> more) return std::nullopt;
  return v;
}

Result<std::vector<VoxelIndex>> read_voxels(const std::string& file) {
  std::ifstream in(file);
  if (!in) return refuse(Code::kNotFound, "cannot read " + file);
  std::vector<VoxelBox> boxes;
  std::int64_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const auto voxel = parse_voxel(line);
    if (!voxel) {
      return refuse(Code::kMalformed, file + ", line " + std::to_string(number) +
                                          ": must hold one voxel, three whole numbers (map lattice)");
    }
    if (static_cast<std::int64_t>(boxes.size()) == kMaxEditVoxels) {
      return refuse(Code::kTooLarge, file + ", line " + std::to_string(number) + ": one edit holds at most " +
                                         std::to_string(kMaxEditVoxels) + " voxels; give it in parts");
    }
    boxes.push_back({*voxel, *voxel});
  }
  if (in.bad()) return refuse(Code::kIo, "cannot read " + file + " to its end");
  return expand(boxes, kMaxEditVoxels);
}

Result<std::vector<VoxelIndex>> selected(const Result<Shape>& shape, double resolution) {
  if (!shape) return tl::unexpected(shape.error());
  return select(*shape, Transform::Identity(), resolution, kMaxEditVoxels);
}

Result<std::vector<VoxelIndex>> voxels_of(const Options& options, double resolution) {
  if (!options.box.empty())
    return selected(parse_box(options.box).map([](const Box& box) { return Shape(box); }), resolution);
  const auto as_line = [&](std::vector<Eigen::Vector3d> points) {
    return Shape(Line{std::move(points), options.thickness});
  };
  if (!options.line.empty()) return selected(parse_points(options.line).map(as_line), resolution);
  const auto as_area = [&](std::vector<Eigen::Vector3d> points) {
    return Shape(Area{std::move(points), options.thickness});
  };
  if (!options.area.empty()) return selected(parse_points(options.area).map(as_area), resolution);
  return read_voxels(options.file);
}

/// The corners of the box around the voxels, metres. @pre there are some.
Box box_around(const std::vector<VoxelIndex>& voxels, double resolution) {
  Box box{Eigen::Vector3d::Constant(kMaxVoxel), Eigen::Vector3d::Constant(-kMaxVoxel)};
  for (const VoxelIndex& v : voxels) {
    const Eigen::Vector3d low(v.x, v.y, v.z);
    box = {box.min.cwiseMin(low), box.max.cwiseMax(low + Eigen::Vector3d::Ones())};
  }
  return {box.min * resolution, box.max * resolution};
}

std::string in_words(const Eigen::Vector3d& p) {
  return "(" + format_number(p.x(), 2) + ", " + format_number(p.y(), 2) + ", " + format_number(p.z(), 2) + ")";
}

/// Where the pins are is said in any case: corners may be given in any order, and voxels in indices.
void print_pinned(const Answer& answer, const Box& box, const Common& common) {
  nlohmann::json object = to_json(answer);
  object["id"] = answer.id;
  object["box"] = {{"min", {box.min.x(), box.min.y(), box.min.z()}}, {"max", {box.max.x(), box.max.y(), box.max.z()}}};
  common.print(object, answer.process + ": " + answer.message + ": " + format_count(answer.count) + " voxels from " +
                           in_words(box.min) + " to " + in_words(box.max) + " m, edit " + answer.id);
}

Outcome edit(const Options& options, const Common& common) {
  auto voxels = voxels_of(options, common.site().resolution);
  if (!voxels) return fail(voxels.error());
  if (voxels->empty()) return fail(Exit::kUnusable, name(Code::kEmpty), "there is no voxel to pin");
  Live live(common);
  const auto op = options.op == "add" ? EditRequest::Op::kAdd : EditRequest::Op::kDelete;
  const Box box = box_around(*voxels, live.site().resolution);
  const EditRequest request{live.new_id(), author_or_user(options.author), op, std::move(*voxels), live.bus().now()};
  const auto answer = live.ask("in/edit", encode(request, live.site().resolution), request.id);
  if (!answer) return tl::unexpected(answer.error());
  print_pinned(*answer, box, common);
  return Exit::kDone;
}

}  // namespace

void add_edit(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& pin = program.add("edit", "pins voxels of the map, above every sensor",
                              [options](const Common& common) { return edit(*options, common); });
  pin.add_option("op", options->op, "add or delete")->required()->check(CLI::IsMember({"add", "delete"}));
  auto* what = pin.add_option_group("selection", "what is pinned, in metres and the map frame");
  what->add_option("--box", options->box,
                   "\"x0 y0 z0 x1 y1 z1\", two opposite corners: every voxel that shares volume with it");
  what->add_option("--line", options->line, "\"x y z x y z ...\": every voxel that it touches");
  what->add_option("--area", options->area, "\"x y z x y z ...\", a polygon: every voxel that it touches");
  what->add_option("--voxels", options->file, "a file with three indices a line, map lattice");
  what->require_option(1);
  pin.add_option("--thickness", options->thickness, "of a line or area: voxels within half of it are pinned too");
  pin.add_option("--author", options->author, "who edits; without it $USER");
}

}  // namespace concord
