#include "core/corrections.hpp"

#include <algorithm>

namespace concord {
namespace {

using Kind = Operation::Kind;

struct Summarise {
  Operation& out;

  void operator()(const Correction::Edit& edit) const {
    switch (edit.op) {
      case EditRequest::Op::kAdd: out.kind = Kind::kAdd; break;
      case EditRequest::Op::kDelete: out.kind = Kind::kDelete; break;
      case EditRequest::Op::kMove: out.kind = Kind::kMove; break;
    }
    out.count = static_cast<std::int64_t>(edit.added.size() + edit.deleted.size());
    out.min = {kMaxVoxel, kMaxVoxel, kMaxVoxel};
    out.max = {-kMaxVoxel, -kMaxVoxel, -kMaxVoxel};
    for (const auto* voxels : {&edit.added, &edit.deleted}) {
      for (const VoxelIndex v : *voxels) {
        out.min = {std::min(out.min.x, v.x), std::min(out.min.y, v.y), std::min(out.min.z, v.z)};
        out.max = {std::max(out.max.x, v.x), std::max(out.max.y, v.y), std::max(out.max.z, v.z)};
      }
    }
  }
  void operator()(const Correction::Undo& undo) const {
    out.kind = undo.redo ? Kind::kRedo : Kind::kUndo;
    out.subject = undo.edit_id;
  }
  void operator()(const Correction::ZoneChange& change) const {
    switch (change.op) {
      case ZoneRequest::Op::kAdd: out.kind = Kind::kZoneAdd; break;
      case ZoneRequest::Op::kChange: out.kind = Kind::kZoneChange; break;
      case ZoneRequest::Op::kDelete: out.kind = Kind::kZoneDelete; break;
    }
    out.subject = change.zone.name;
  }
  void operator()(const Correction::Placement& placement) const {
    out.kind = Kind::kTransform;
    out.subject = placement.agent;
  }
  void operator()(const Correction::Weight& weight) const {
    out.kind = Kind::kWeight;
    out.subject = weight.agent;
  }
};

}  // namespace

Result<void> check_terms(Zone::Kind kind, double margin, int cost) {
  const bool may_have_margin = kind == Zone::Kind::kNoGo || kind == Zone::Kind::kCostly;
  if (!(margin >= 0 && margin <= (may_have_margin ? Zone::kMaxMargin : 0.0))) {
    return refuse(Code::kBadRequest, "the margin of a no-go or costly zone is 0 to 10 m, others have none");
  }
  const bool is_costly = kind == Zone::Kind::kCostly;
  if (is_costly ? cost < 1 || cost > Zone::kMaxCost : cost != 0) {
    return refuse(Code::kBadRequest, "the cost of a costly zone is 1 to 15, others have none");
  }
  return {};
}

std::optional<Kind> operation_called(std::string_view name) {
  const auto* known = std::ranges::find(kOperationNames, name);
  if (known == kOperationNames.end()) return std::nullopt;
  return static_cast<Kind>(known - kOperationNames.begin());
}

Operation summary(const Correction& correction, bool active) {
  Operation out;
  out.revision = correction.revision;
  out.id = correction.id;
  out.author = correction.author;
  out.utime = correction.utime;
  out.active = active;
  std::visit(Summarise{out}, correction.what);
  return out;
}

}  // namespace concord
