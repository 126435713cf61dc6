#include "bridge/convert.hpp"

#include <utility>

namespace concord::hmd {
namespace {

Box box_to_hmd(const concord::Box& box) { return {array_of(box.min), array_of(box.max)}; }

struct VolumeToHmd {
  Volume operator()(const concord::Box& box) const { return box_to_hmd(box); }
  Volume operator()(const concord::OrientedBox& box) const {
    return OrientedBox{to_hmd(box.T_frame_box), array_of(box.size)};
  }
  Volume operator()(const concord::Prism& prism) const {
    Prism out{{}, prism.low, prism.high};
    for (const Eigen::Vector2d& p : prism.points) out.points.push_back({p.x(), p.y()});
    return out;
  }
};

std::vector<Eigen::Vector3d> points_of(const std::vector<std::array<double, 3>>& points) {
  std::vector<Eigen::Vector3d> out;
  for (const auto& p : points) out.push_back(vector_of(p));
  return out;
}

/// Each kind alike for shapes and volumes.
struct FromHmd {
  Result<concord::Shape> operator()(const Voxels& voxels) const {
    concord::VoxelList out;
    out.resolution = voxels.resolution;
    for (const auto& b : voxels.boxes) out.boxes.push_back({{b[0], b[1], b[2]}, {b[3], b[4], b[5]}});
    return out;
  }
  Result<concord::Shape> operator()(const Line& line) const {
    return concord::Line{points_of(line.points), line.thickness};
  }
  Result<concord::Shape> operator()(const Area& area) const {
    return concord::Area{points_of(area.points), area.thickness};
  }
  Result<concord::Shape> operator()(const Box& box) const {
    return concord::Box{vector_of(box.min), vector_of(box.max)};
  }
  Result<concord::Shape> operator()(const OrientedBox& box) const {
    const auto T = from_hmd(box.T_frame_box);
    if (!T) return tl::unexpected(T.error());
    return concord::OrientedBox{*T, vector_of(box.size)};
  }
  Result<concord::Shape> operator()(const Prism& prism) const {
    concord::Prism out{{}, prism.low, prism.high};
    for (const auto& p : prism.points) out.points.emplace_back(p[0], p[1]);
    return out;
  }
};

}  // namespace

Pose to_hmd(const Transform& T) {
  const Eigen::Quaterniond q(T.linear());
  return {array_of(T.translation()), {q.x(), q.y(), q.z(), q.w()}};
}

Volume to_hmd(const concord::Volume& volume) { return std::visit(VolumeToHmd{}, volume); }

Zone to_hmd(const concord::Zone& zone) {
  return {zone.name,           zone.kind == concord::Zone::Kind::kNoGo ? ZoneKind::kNoGo : ZoneKind::kAllowContact,
          to_hmd(zone.volume), to_hmd(zone.T_map_zone),
          zone.author,         zone.revision};
}

Lease to_hmd(const concord::Lease& lease) {
  return {lease.id, lease.author, to_hmd(lease.volume), to_hmd(lease.T_map_lease), lease.until};
}

Operation to_hmd(const concord::Operation& o) {
  return {o.revision, o.id, o.author, o.utime, static_cast<OperationKind>(o.kind), o.subject, o.count, o.active};
}

Agent to_hmd(const AgentState& a) {
  Agent agent{a.id, a.kind, a.frame_id, a.aligned, {}, a.weight, a.revision, a.known, a.occupied};
  if (a.aligned) agent.T_map_agent = to_hmd(a.T_map_agent);
  return agent;
}

ConflictRegion to_hmd(const concord::ConflictRegion& r) {
  ConflictRegion region{{r.min.x, r.min.y, r.min.z}, {r.max.x, r.max.y, r.max.z}, r.voxels, {}};
  for (const auto& claim : r.claims) region.claims.push_back({claim.agent, claim.occupied, claim.free});
  return region;
}

Result<Transform> from_hmd(const Pose& pose) {
  return make_transform(vector_of(pose.position), vector_of(pose.rotation));
}

Result<concord::Shape> from_hmd(const Shape& shape) {
  auto out = std::visit(FromHmd{}, shape);
  if (!out) return out;
  if (const auto fine = check(*out); !fine) return tl::unexpected(fine.error());
  return out;
}

Result<concord::Volume> from_hmd(const Volume& volume) {
  auto shape = std::visit(FromHmd{}, volume);
  if (!shape) return tl::unexpected(std::move(shape.error()));
  concord::Volume out;
  if (auto* box = std::get_if<concord::Box>(&*shape)) out = *box;
  if (auto* box = std::get_if<concord::OrientedBox>(&*shape)) out = *box;
  if (auto* prism = std::get_if<concord::Prism>(&*shape)) out = std::move(*prism);
  if (const auto fine = check(out); !fine) return tl::unexpected(fine.error());
  if (const auto* prism = std::get_if<concord::Prism>(&out);
      prism != nullptr && prism->points.size() > kMaxVolumePoints) {
    return concord::refuse(concord::Code::kTooLarge, "a region has at most 64 corners");
  }
  return out;
}

concord::Zone::Kind from_hmd(ZoneKind kind) {
  return kind == ZoneKind::kNoGo ? concord::Zone::Kind::kNoGo : concord::Zone::Kind::kAllowContact;
}

static_assert(static_cast<int>(OperationKind::kWeight) == static_cast<int>(concord::Operation::Kind::kWeight),
              "the schema names kinds of operations in the order of core/corrections.hpp");
concord::Operation::Kind from_hmd(OperationKind kind) { return static_cast<concord::Operation::Kind>(kind); }

Code code_of(const std::string& name) {
  static const std::pair<const char*, Code> kOthers[] = {{"MALFORMED", Code::kBadRequest},
                                                         {"NOT_FINITE", Code::kBadRequest},
                                                         {"BAD_TRANSFORM", Code::kBadRequest},
                                                         {"NOT_ALIGNED", Code::kUnaligned},
                                                         {"VALIDATION_FAILED", Code::kUnreachable}};
  for (const auto& [theirs, ours] : kOthers) {
    if (name == theirs) return ours;
  }
  Code code = Code::kBadRequest;
  Problem none;
  return read_value(Json(name), code, none) ? code : Code::kBadRequest;
}

}  // namespace concord::hmd
