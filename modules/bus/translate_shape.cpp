#include "bus/translate_shape.hpp"

namespace concord::wire {
namespace {

/// Fills in what a kind of shape has; all else is 0.
struct Put {
  shape_t& out;

  void operator()(const VoxelList& list) const {
    out.kind = shape_t::VOXELS;
    out.resolution = list.resolution;
    out.boxes = static_cast<std::int32_t>(list.boxes.size());
    for (const VoxelBox& box : list.boxes) {
      out.min_x.push_back(box.min.x);
      out.min_y.push_back(box.min.y);
      out.min_z.push_back(box.min.z);
      out.max_x.push_back(box.max.x);
      out.max_y.push_back(box.max.y);
      out.max_z.push_back(box.max.z);
    }
  }
  void operator()(const Line& line) const {
    out.kind = shape_t::LINE;
    out.thickness = line.thickness;
    put_points(line.points, out);
  }
  void operator()(const Area& area) const {
    out.kind = shape_t::AREA;
    out.thickness = area.thickness;
    put_points(area.points, out);
  }
  void operator()(const Box& box) const {
    out.kind = shape_t::BOX;
    put_points(std::vector<Eigen::Vector3d>{box.min, box.max}, out);
  }
  void operator()(const OrientedBox& box) const {
    out.kind = shape_t::ORIENTED_BOX;
    put_points(std::vector<Eigen::Vector3d>{box.size}, out);
    out.T_frame_box = to_wire(box.T_frame_box);
  }
  void operator()(const Prism& prism) const {
    out.kind = shape_t::PRISM;
    out.low = prism.low;
    out.high = prism.high;
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector2d& p : prism.points) points.emplace_back(p.x(), p.y(), 0.0);
    put_points(points, out);
  }
};

template <class AnyShape>
shape_t put(const AnyShape& shape) {
  shape_t out{};
  out.T_frame_box = to_wire(Transform::Identity());
  std::visit(Put{out}, shape);
  return out;
}

template <class AnyShape>
Result<AnyShape> checked(AnyShape shape) {
  return check(shape).map([&] { return std::move(shape); });
}

Result<void> check_corners(const shape_t& in, const char* kind, std::int32_t corners) {
  if (in.count == corners) return {};
  return refuse(Code::kBadShape, std::string(kind) + " has " + std::to_string(corners) + " corners, see shape_t.lcm");
}

VoxelList voxels_of(const shape_t& in) {
  VoxelList list{in.resolution, {}};
  list.boxes.reserve(in.min_x.size());
  for (std::size_t i = 0; i < in.min_x.size(); ++i) {
    list.boxes.push_back({{in.min_x[i], in.min_y[i], in.min_z[i]}, {in.max_x[i], in.max_y[i], in.max_z[i]}});
  }
  return list;
}

Result<Volume> box_of(const shape_t& in) {
  return check_corners(in, "a BOX", 2).and_then([&] {
    const auto corners = points_of<Eigen::Vector3d>(in);
    return checked(Volume(Box{corners[0], corners[1]}));
  });
}

Result<Volume> oriented_box_of(const shape_t& in) {
  return check_corners(in, "an ORIENTED_BOX", 1)
      .and_then([&] { return from_wire(in.T_frame_box); })
      .and_then([&](const Transform& T_frame_box) {
        return checked(Volume(OrientedBox{T_frame_box, points_of<Eigen::Vector3d>(in)[0]}));
      });
}

Result<Volume> prism_of(const shape_t& in) {
  Prism prism{{}, in.low, in.high};
  for (std::size_t i = 0; i < in.x.size(); ++i) prism.points.emplace_back(in.x[i], in.y[i]);
  return checked(Volume(std::move(prism)));
}

Result<Volume> volume_of(const shape_t& in) {
  switch (in.kind) {
    case shape_t::BOX: return box_of(in);
    case shape_t::ORIENTED_BOX: return oriented_box_of(in);
    case shape_t::PRISM: return prism_of(in);
    default: return refuse(Code::kBadShape, "a volume is a BOX, an ORIENTED_BOX or a PRISM");
  }
}

Result<void> check_boxes(const shape_t& in) {
  if (in.kind == shape_t::VOXELS || in.boxes == 0) return {};
  return refuse(Code::kBadShape, "boxes of voxels come with the kind VOXELS");
}

Result<Shape> shape_of(const shape_t& in) {
  switch (in.kind) {
    case shape_t::VOXELS:
      return check_corners(in, "a list of VOXELS", 0).and_then([&] { return checked(Shape(voxels_of(in))); });
    case shape_t::LINE: return checked(Shape(Line{points_of<Eigen::Vector3d>(in), in.thickness}));
    case shape_t::AREA: return checked(Shape(Area{points_of<Eigen::Vector3d>(in), in.thickness}));
    case shape_t::BOX:
    case shape_t::ORIENTED_BOX:
    case shape_t::PRISM:
      return volume_of(in).map(
          [](const Volume& volume) { return std::visit([](const auto& any) { return Shape(any); }, volume); });
    default: return refuse(Code::kBadShape, "kind must be VOXELS, LINE, AREA, BOX, ORIENTED_BOX or PRISM");
  }
}

}  // namespace

shape_t to_wire(const Shape& shape) { return put(shape); }
shape_t to_wire(const Volume& volume) { return put(volume); }

Result<Shape> shape_from_wire(const shape_t& in) {
  return check_boxes(in).and_then([&] { return shape_of(in); });
}

Result<Volume> volume_from_wire(const shape_t& in) {
  if (in.x.size() > kMaxVolumePoints) {
    return refuse(Code::kTooLarge, "a volume has at most " + std::to_string(kMaxVolumePoints) + " corners");
  }
  return check_boxes(in).and_then([&] { return volume_of(in); });
}

Result<std::string> title_of(const std::string& name) {
  if (is_title(name)) return name;
  return refuse(Code::kBadName, std::string("a name for people (of a class, a zone) must be ") + kTitleRule);
}

Result<std::string> kept_title_of(const std::string& name) {
  if (is_kept_title(name)) return name;
  return refuse(Code::kBadName, std::string("a name for people (of a class, a zone) is ") + kKeptTitleRule);
}

std::int8_t to_wire(Zone::Kind kind) {
  switch (kind) {
    case Zone::Kind::kNoGo: return zone_t::NO_GO;
    case Zone::Kind::kAllowContact: return zone_t::ALLOW_CONTACT;
    case Zone::Kind::kCostly: return zone_t::COSTLY;
    case Zone::Kind::kCorridor: return zone_t::CORRIDOR;
  }
  return 0;
}

Result<Zone::Kind> zone_kind(std::int8_t kind) {
  switch (kind) {
    case zone_t::NO_GO: return Zone::Kind::kNoGo;
    case zone_t::ALLOW_CONTACT: return Zone::Kind::kAllowContact;
    case zone_t::COSTLY: return Zone::Kind::kCostly;
    case zone_t::CORRIDOR: return Zone::Kind::kCorridor;
    default: return refuse(Code::kBadRequest, "kind must be NO_GO, ALLOW_CONTACT, COSTLY or CORRIDOR");
  }
}

}  // namespace concord::wire
