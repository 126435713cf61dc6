// What may be asked of the labels: the half of Labels that changes nothing.

#include <algorithm>
#include <functional>

#include "core/text.hpp"
#include "core/voxel_runs.hpp"
#include "semantic/labels/labels.hpp"

namespace concord {
namespace {

using Claim = LabelCorrection::Claim;
using Rename = LabelCorrection::Rename;
using Reassign = LabelCorrection::Reassign;
using TakeOff = LabelCorrection::TakeOff;
using Undo = LabelCorrection::Undo;

constexpr std::uint32_t kMostGiven = (1U << 31) - 1;  ///< of a class or instance, by us
constexpr std::uint32_t kMostNumber = 1U << 30;  ///< of a class or instance, from outside: some are left to be given
constexpr const char* kNoTitle = "a class's name is 1 to 80 bytes of printable text without slashes";

std::string words(InstanceId of) {
  return "instance " + std::to_string(of.instance) + " of class " + std::to_string(of.label);
}

/// One that was never given: after the highest; where a map was loaded that has the last of all, the first that is
/// left.
/// @param given ascending, fewer than there are numbers
/// @param number_of one of them
template <class Given, class NumberOf = std::identity>
std::uint32_t next(const Given& given, NumberOf number_of = {}) {
  std::uint32_t gap = 1;
  if (given.empty()) return gap;
  if (const std::uint32_t highest = number_of(*given.rbegin()); highest < kMostGiven) return highest + 1;
  for (const auto& one : given) {
    if (number_of(one) != gap) break;
    ++gap;
  }
  return gap;
}

}  // namespace

Result<Labels::What> Labels::check(const LabelRequest& request, const std::vector<VoxelIndex>& voxels) const {
  if (made_.size() >= kMaxLabelCorrections) {
    return refuse(Code::kTooLarge, "no more is kept than " + std::to_string(kMaxLabelCorrections) +
                                       " label requests; save the labels as .pcd and begin with a new state folder");
  }
  switch (request.op) {
    case LabelRequest::Op::kLabel:
    case LabelRequest::Op::kTouch:
    case LabelRequest::Op::kRestore: return check_claim(request, voxels);
    case LabelRequest::Op::kRename: return check_rename(request);
    case LabelRequest::Op::kReassign: return check_reassign(request);
    case LabelRequest::Op::kTakeOff: return check_take_off(request);
    case LabelRequest::Op::kDelete:  // an edit, not a label correction
    case LabelRequest::Op::kUndo:
    case LabelRequest::Op::kRedo: break;
  }
  if (const auto it = by_id_.find(request.correction_id); it != by_id_.end()) {
    const std::string& edit = steps_[it->second].claim.edit_id;
    if (!edit.empty()) return refuse(Code::kBadRequest, "it came with an edit, as one thing: undo or redo " + edit);
  }
  return check_undo(request);
}

Result<void> Labels::check_instance(InstanceId of) const {
  const auto it = classes_.find(of.label);
  if (it == classes_.end())
    return refuse(Code::kNotFound, "no class " + std::to_string(of.label) + "; see: concord labels");
  if (of.instance != 0 && !it->second.given.contains(of.instance))
    return refuse(Code::kNotFound, "no " + words(of) + "; see: concord labels");
  return {};
}

Result<void> Labels::check_voxels(const std::vector<VoxelIndex>& voxels) const {
  const auto many = static_cast<std::int64_t>(voxels.size());
  if (many == 0) return refuse(Code::kEmpty, "nothing is occupied there");
  if (many > kMaxLabelVoxels) return refuse_too_many(kMaxLabelVoxels);
  if (many > kMaxAllLabelVoxels - voxels_) return refuse_too_many(kMaxAllLabelVoxels);
  if (many > kMaxLabelVoxelsEver - voxels_ever_) return refuse_too_many(kMaxLabelVoxelsEver);
  // Counted only where they might be too many: no voxel lies in two bricks.
  const std::int64_t left = kMaxLabelBricks - bricks_ever_;
  if (many > left && static_cast<std::int64_t>(masks_of(voxels).brick_count()) > left) {
    return refuse(Code::kTooLarge, "all labels together, undone ones too, may lie in " +
                                       std::to_string(kMaxLabelBricks) + " bricks of 8 voxels");
  }
  if (!std::ranges::all_of(voxels, [](VoxelIndex v) { return in_bounds(v); })) {
    return refuse(Code::kOutOfBounds, "a voxel lies beyond the map's bounds");
  }
  return {};
}

/// Whether there is room for one more class or instance, if it is one.
Result<void> Labels::check_room(InstanceId of) const {
  const auto known = classes_.find(of.label);
  if (known == classes_.end() && classes_.size() >= kMaxClasses) {
    return refuse(Code::kTooLarge, "there are too many classes already");
  }
  const bool is_new = known == classes_.end() || !known->second.given.contains(of.instance);
  if (is_new && instances_ >= kMaxInstances) return refuse(Code::kTooLarge, "no more instances can be told apart");
  return {};
}

Result<Labels::What> Labels::check_claim(const LabelRequest& request, const std::vector<VoxelIndex>& voxels) const {
  if (const auto fine = check_voxels(voxels); !fine) return tl::unexpected(fine.error());
  if (!is_title(request.name)) return refuse(Code::kBadName, kNoTitle);
  auto claim = request.op == LabelRequest::Op::kRestore ? restored(request) : numbered(request);
  if (!claim) return tl::unexpected(claim.error());
  if (const auto room = check_room(claim->of); !room) return tl::unexpected(room.error());
  claim->voxels = voxels;
  return std::move(*claim);
}

/// The numbers that a label gets.
Result<Claim> Labels::numbered(const LabelRequest& request) const {
  Claim claim;
  const auto known = class_called(request.name);
  if (known) {
    claim.of.label = *known;
    if (const auto there = check_instance({*known, request.of.instance}); !there) return tl::unexpected(there.error());
  } else {
    if (request.of.instance != 0) return refuse(Code::kNotFound, "no class " + request.name + "; see: concord labels");
    claim.of.label = next(classes_, [](const auto& entry) { return entry.first; });
    claim.class_name = request.name;
  }
  claim.of.instance = request.of.instance;
  if (claim.of.instance == 0) claim.of.instance = known ? next(classes_.at(*known).given) : 1;
  return claim;
}

/// The numbers that a saved cloud says, unless they belong to something else here.
Result<Claim> Labels::restored(const LabelRequest& request) const {
  if (request.of.label == 0 || request.of.instance == 0 || request.of.label > kMostNumber ||
      request.of.instance > kMostNumber) {
    return refuse(Code::kBadRequest, "to restore a label takes its class's and its own number");
  }
  const auto there = classes_.find(request.of.label);
  const auto named = class_called(request.name);
  if (there == classes_.end() ? named.has_value() : there->second.name != request.name) {
    return refuse(Code::kConflict,
                  "class " + std::to_string(request.of.label) + " is another one here than " + request.name);
  }
  return Claim{request.of, there == classes_.end() ? request.name : "", {}, {}, {}};
}

Result<Labels::What> Labels::check_rename(const LabelRequest& request) const {
  if (const auto there = check_instance({request.of.label, 0}); !there) return tl::unexpected(there.error());
  if (const auto fine = check_new_name(request.name); !fine) return tl::unexpected(fine.error());
  return Rename{request.of.label, request.name};
}

Result<Labels::What> Labels::check_reassign(const LabelRequest& request) const {
  if (request.of.instance == 0)
    return refuse(Code::kBadRequest, "one instance is reassigned, not a class; rename that");
  if (const auto there = check_instance(request.of); !there) return tl::unexpected(there.error());
  const auto label = class_called(request.name);
  if (!label) return refuse(Code::kNotFound, "no class " + request.name + "; label something with it first");
  InstanceId to{*label, request.to_instance};
  if (const auto there = check_instance(to); !there) return tl::unexpected(there.error());
  if (to.instance == 0) {
    if (instances_ >= kMaxInstances) return refuse(Code::kTooLarge, "no more instances can be told apart");
    to.instance = next(classes_.at(*label).given);
  }
  if (to == request.of) return refuse(Code::kConflict, "it is that instance already");
  return Reassign{request.of, to};
}

Result<Labels::What> Labels::check_take_off(const LabelRequest& request) const {
  if (const auto there = check_instance(request.of); !there) return tl::unexpected(there.error());
  return TakeOff{request.of};
}

Result<Labels::What> Labels::check_undo(const LabelRequest& request) const {
  const bool redo = request.op == LabelRequest::Op::kRedo;
  const auto it = by_id_.find(request.correction_id);
  if (it == by_id_.end()) return refuse(Code::kNotFound, "no label correction " + request.correction_id);
  const Step& step = steps_[it->second];
  if (std::holds_alternative<Undo>(step.what))
    return refuse(Code::kBadRequest, "an undo is not undone; redo what it undid");
  if (step.active == redo) {
    return refuse(Code::kConflict, request.correction_id + (redo ? " is not undone" : " is undone already"));
  }
  if (redo && step.is_claim && step.claim.edit_id.empty() && made_[it->second].count > kMaxAllLabelVoxels - voxels_) {
    return refuse_too_many(kMaxAllLabelVoxels);
  }
  if (std::holds_alternative<Rename>(step.what)) {
    std::vector<std::string> names;
    for (const auto& [id, name] : names_if(it->second, redo)) names.push_back(name);
    std::ranges::sort(names);
    if (std::ranges::adjacent_find(names) != names.end()) {
      return refuse(Code::kConflict, "another class has that name now; rename it first");
    }
  }
  return Undo{request.correction_id, redo};
}

struct Labels::Follow {
  const Labels& labels;

  Result<void> operator()(const Claim& claim) const {
    if (const auto fine = is_number(claim.of.label).and_then([&] { return is_number(claim.of.instance); }); !fine) {
      return fine;
    }
    if (const auto fine = labels.check_voxels(claim.voxels); !fine) return fine;
    if (std::ranges::adjacent_find(claim.voxels, std::greater_equal<>()) != claim.voxels.end()) {
      return refuse(Code::kBadRequest, "its voxels are not sorted and unique");
    }
    if (labels.classes_.contains(claim.of.label) != claim.class_name.empty()) {
      return refuse(Code::kConflict, "a class is named when it comes first, and then only");
    }
    if (!claim.class_name.empty()) {
      if (const auto fine = labels.check_new_name(claim.class_name); !fine) return fine;
    }
    if (!claim.edit_id.empty()) {
      if (const auto fine = check(claim); !fine) return fine;
    }
    if (const auto fine = check(claim.anchor); !fine) return fine;
    return labels.check_room(claim.of);
  }
  Result<void> operator()(const Rename& rename) const {
    return labels.check_instance({rename.label, 0}).and_then([&] { return labels.check_new_name(rename.name); });
  }
  Result<void> operator()(const Reassign& reassign) const {
    if (reassign.from == reassign.to) return refuse(Code::kConflict, "it is that instance already");
    return is_number(reassign.to.instance)
        .and_then([&] { return is_number(reassign.from.instance); })
        .and_then([&] { return labels.check_instance(reassign.from); })
        .and_then([&] {
          return labels.check_instance({reassign.to.label, 0});
        })
        .and_then([&] { return labels.check_room(reassign.to); });
  }
  Result<void> operator()(const TakeOff& take_off) const { return labels.check_instance(take_off.of); }
  Result<void> operator()(const Undo& undo) const {
    LabelRequest request;
    request.op = undo.redo ? LabelRequest::Op::kRedo : LabelRequest::Op::kUndo;
    request.correction_id = undo.correction_id;
    if (const auto what = labels.check_undo(request); !what) return tl::unexpected(what.error());
    return {};
  }

  static Result<void> is_number(std::uint32_t number) {
    if (number >= 1 && number <= kMostGiven) return {};
    return refuse(Code::kBadRequest, "numbers of classes and instances count from 1");
  }
  static Result<void> check(const LabelAnchor& anchor) {
    if (anchor.agent.empty()) return {};
    if (!is_name(anchor.agent) || !is_name(anchor.frame_id)) return refuse(Code::kBadName, "it lies on no agent");
    if (!is_placement(anchor.T_map_agent)) return refuse(Code::kBadTransform, "its agent lies nowhere");
    return {};
  }
  static Result<void> check(const Claim& claim) {
    const Injection& injection = claim.injection;
    if (!is_kept_id(claim.edit_id) || !is_name(injection.asset))
      return refuse(Code::kBadName, "its asset or edit is none");
    if (!injection.replaces.empty() && !is_kept_id(injection.replaces)) {
      return refuse(Code::kBadName, "it replaces an edit that is none");
    }
    if (!is_placement(injection.T_map_asset)) return refuse(Code::kBadTransform, "its asset lies nowhere");
    return {};
  }
  static bool is_placement(const Transform& T) {
    return is_rotation(T.linear()) && T.translation().allFinite() &&
           T.translation().cwiseAbs().maxCoeff() <= kFarthestPlacement;
  }
};

Result<void> Labels::check_new_name(const std::string& name) const {
  if (!is_title(name)) return refuse(Code::kBadName, kNoTitle);
  if (class_called(name)) return refuse(Code::kExists, "a class " + name + " exists");
  return {};
}

Result<void> Labels::follows(const LabelCorrection& correction) const {
  if (correction.revision <= revision()) return refuse(Code::kStale, "its revision is not above the one before");
  if (!is_kept_id(correction.id) || !is_kept_author(correction.author)) {
    return refuse(Code::kBadName, "its id or author is none");
  }
  if (by_id_.contains(correction.id)) return refuse(Code::kExists, "another one has the id " + correction.id);
  return std::visit(Follow{*this}, correction.what);
}

}  // namespace concord
