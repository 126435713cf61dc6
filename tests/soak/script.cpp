#include "script.hpp"

#include <algorithm>

#include "building.hpp"

namespace concord::soak {

std::vector<Request> Script::opening() {
  std::vector<Request> out;
  for (const char* robot : {"robot1", "robot2"})
    out.emplace_back(TransformRequest{new_id(), "opening", robot, "frame1", Transform::Identity()});
  return out;
}

Request Script::next(const std::string& author) {
  const int dice = whole(1, 100);
  if (dice <= 50) return edit(author);
  if (dice <= 70) return undo(author);
  if (dice <= 85) return zone(author);
  if (dice <= 91) return alignment(author);
  if (dice <= 94) return weight(author);
  return lease(author);
}

void Script::granted(const Request& request, std::int64_t revision) {
  revision_ = std::max(revision_, revision);
  if (std::holds_alternative<EditRequest>(request)) edits_.push_back(id_of(request));
}

std::string Script::new_id() { return "soak-" + std::to_string(++count_); }

Eigen::Vector3d Script::place() {
  return {real(-kHalfWidth, kHalfWidth), real(-kHalfWidth, kHalfWidth), real(0, kHeight)};
}

Transform Script::pose() {
  Transform T = Transform::Identity();
  T.translate(Eigen::Vector3d(real(-1, 1), real(-1, 1), real(-0.2, 0.2)));
  T.rotate(Eigen::AngleAxisd(real(-3, 3), Eigen::Vector3d::UnitZ()));
  if (whole(0, 3) == 0) T.rotate(Eigen::AngleAxisd(real(-0.1, 0.1), Eigen::Vector3d::UnitX()));
  return T;
}

Volume Script::volume() {
  const Eigen::Vector3d p = place();
  switch (whole(0, 2)) {
    case 0: return Box{p, p + Eigen::Vector3d(real(0, 1.5), real(0, 1.5), real(0, 1))};
    case 1: {
      Transform T = pose();
      T.pretranslate(p);
      return OrientedBox{T, {real(0.1, 1.5), real(0.1, 1.5), real(0.1, 1)}};
    }
    default: {
      const Eigen::Vector2d corner = p.head<2>();
      return Prism{{corner, corner + Eigen::Vector2d(real(0.5, 2), 0), corner + Eigen::Vector2d(0, real(0.5, 2))},
                   p.z(),
                   p.z() + real(0.1, 1)};
    }
  }
}

Shape Script::shape() {
  const Eigen::Vector3d p = place();
  switch (whole(0, 3)) {
    case 0: return Line{{p, place()}, real(0, 0.2)};
    case 1: return Area{{p, p + Eigen::Vector3d(real(0.3, 2), 0, 0), p + Eigen::Vector3d(0, 0, real(0.3, 2))}, 0};
    case 2: {
      const VoxelIndex v = voxel_of(p, kResolution);
      return VoxelList{kResolution, {{v, {v.x + whole(0, 3), v.y + whole(0, 3), v.z}}}};
    }
    default: return std::visit([](const auto& of) { return Shape(of); }, volume());
  }
}

WorkFrame Script::frame() { return whole(0, 3) == 0 ? WorkFrame{"robot2", "frame1"} : WorkFrame{}; }

Request Script::edit(const std::string& author) {
  EditRequest out;
  out.id = new_id();
  out.author = author;
  const int dice = whole(0, 4);
  out.op = dice < 2 ? EditRequest::Op::kAdd : dice < 4 ? EditRequest::Op::kDelete : EditRequest::Op::kMove;
  out.shape = shape();
  out.frame = frame();
  if (out.op == EditRequest::Op::kMove) out.move = {real(-1, 1), real(-1, 1), real(-0.5, 0.5)};
  if (whole(0, 4) == 0) out.base_revision = std::max<std::int64_t>(0, revision_ - whole(0, 20));
  return out;
}

Request Script::undo(const std::string& author) {
  if (edits_.empty()) return edit(author);
  const int last = static_cast<int>(edits_.size()) - 1;
  const std::string& edit_id = edits_[static_cast<std::size_t>(whole(std::max(0, last - 60), last))];
  return UndoRequest{new_id(), author, edit_id, whole(0, 1) == 0};
}

Request Script::zone(const std::string& author) {
  ZoneRequest out;
  out.id = new_id();
  out.author = author;
  const int dice = whole(0, 3);
  out.op = dice < 2 ? ZoneRequest::Op::kAdd : dice == 2 ? ZoneRequest::Op::kChange : ZoneRequest::Op::kDelete;
  out.name = "zone " + std::to_string(whole(1, 40));
  out.kind = whole(0, 1) == 0 ? Zone::Kind::kNoGo : Zone::Kind::kAllowContact;
  out.volume = volume();
  out.frame = frame();
  return out;
}

Request Script::alignment(const std::string& author) {
  return TransformRequest{new_id(), author, whole(0, 1) == 0 ? "robot1" : "robot2", "frame1", pose()};
}

Request Script::weight(const std::string& author) {
  return WeightRequest{new_id(), author, whole(0, 1) == 0 ? "robot1" : "robot2", whole(1, 10)};
}

Request Script::lease(const std::string& author) {
  return LeaseRequest{new_id(), author, "lease of " + author, whole(0, 1) == 0, volume(), frame()};
}

}  // namespace concord::soak
