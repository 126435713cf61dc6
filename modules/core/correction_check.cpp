#include "core/correction_check.hpp"

#include <algorithm>
#include <vector>

#include "core/requests.hpp"
#include "core/text.hpp"

namespace concord {
namespace {

Result<void> check_transform(const Transform& T) {
  if (!T.linear().allFinite() || !T.translation().allFinite()) {
    return refuse(Code::kNotFinite, "transform has a component that is not finite");
  }
  if (!is_rotation(T.linear())) return refuse(Code::kBadTransform, "transform is no rotation and translation");
  if (T.translation().cwiseAbs().maxCoeff() > kFarthestPlacement) {
    return refuse(Code::kBadTransform, "translation is over 10 km; is it in metres?");
  }
  return {};
}

Result<void> check_agent(const std::string& agent) {
  if (is_name(agent)) return {};
  return refuse(Code::kBadName, std::string("an agent's id is ") + kNameRule);
}

Result<void> check_voxels(const std::vector<VoxelIndex>& voxels) {
  if (voxels.size() > static_cast<std::size_t>(kMaxStoredEditVoxels)) {
    return refuse(Code::kTooLarge, "an edit of over " + std::to_string(kMaxStoredEditVoxels) + " voxels");
  }
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    if (!in_bounds(voxels[i])) return refuse(Code::kOutOfBounds, "a voxel of the edit is out of bounds");
    if (i > 0 && !(voxels[i - 1] < voxels[i])) {
      return refuse(Code::kBadRequest, "the voxels of the edit are not sorted and unique");
    }
  }
  return {};
}

/// @pre both sorted.
bool share_any(const std::vector<VoxelIndex>& a, const std::vector<VoxelIndex>& b) {
  auto i = a.begin();
  auto j = b.begin();
  while (i != a.end() && j != b.end()) {
    if (*i == *j) return true;
    if (*i < *j) {
      ++i;
    } else {
      ++j;
    }
  }
  return false;
}

/// Which of its lists an edit fills: a move whose voxels all land on one another deletes none.
bool fits_op(const Correction::Edit& edit) {
  switch (edit.op) {
    case EditRequest::Op::kAdd: return edit.deleted.empty();
    case EditRequest::Op::kDelete: return edit.added.empty();
    case EditRequest::Op::kMove: return !edit.added.empty();
  }
  return false;
}

Result<void> check_volume(const Volume& volume) {
  const auto* prism = std::get_if<Prism>(&volume);
  if (prism != nullptr && prism->points.size() > kMaxVolumePoints) {
    return refuse(Code::kTooLarge, "a zone has over " + std::to_string(kMaxVolumePoints) + " corners");
  }
  return check(volume);
}

}  // namespace

/// What a correction does, asked against all before it and noted.
struct CorrectionCheck::Follow {
  CorrectionCheck& list;
  const std::string& id;

  Result<void> operator()(const Correction::Edit& edit) const {
    if (edit.added.empty() && edit.deleted.empty()) return refuse(Code::kEmpty, "the edit pins no voxel");
    for (const auto* voxels : {&edit.added, &edit.deleted}) {
      if (auto fine = check_voxels(*voxels); !fine) return fine;
    }
    if (!fits_op(edit) || share_any(edit.added, edit.deleted)) {
      return refuse(Code::kBadRequest, "the edit's voxels are not what its op leads to");
    }
    const auto pins = static_cast<std::int64_t>(edit.added.size() + edit.deleted.size());
    if (pins > kMaxPins - list.pins_) {
      return refuse(Code::kTooLarge, "all edits together pin over " + std::to_string(kMaxPins) + " voxels");
    }
    list.pins_ += pins;
    list.edits_.emplace(id, true);
    return {};
  }

  Result<void> operator()(const Correction::Undo& undo) const {
    const auto edit = list.edits_.find(undo.edit_id);
    if (edit == list.edits_.end())
      return refuse(Code::kNotFound, "no edit or placement before this is called " + undo.edit_id);
    if (edit->second == undo.redo) {
      return refuse(Code::kConflict, "edit " + undo.edit_id + (undo.redo ? " was not undone" : " is undone already"));
    }
    edit->second = undo.redo;
    return {};
  }

  Result<void> operator()(const Correction::ZoneChange& change) const {
    const Zone& zone = change.zone;
    if (!is_kept_title(zone.name)) {
      return refuse(Code::kBadName, "a zone's name is one line of 1 to 80 bytes without slashes");
    }
    const bool is_there = list.zones_.contains(zone.name);
    const bool adds = change.op == ZoneRequest::Op::kAdd;
    if (adds && is_there) return refuse(Code::kExists, "there is a zone called " + zone.name);
    if (!adds && !is_there) return refuse(Code::kNotFound, "no zone is called " + zone.name);
    if (change.op == ZoneRequest::Op::kDelete) {
      list.zones_.erase(zone.name);
      return {};
    }
    if (adds && list.zones_.size() >= kMaxZones) {
      return refuse(Code::kTooLarge, "over " + std::to_string(kMaxZones) + " zones");
    }
    if (auto fine = check_volume(zone.volume); !fine) return fine;
    if (auto fine = check_transform(zone.T_map_zone); !fine) return fine;
    list.zones_.insert(zone.name);
    return {};
  }

  Result<void> operator()(const Correction::Placement& placement) const {
    if (auto fine = check_agent(placement.agent); !fine) return fine;
    if (!is_name(placement.frame_id)) return refuse(Code::kBadName, std::string("frame_id must be ") + kNameRule);
    if (auto fine = check_transform(placement.T_map_agent); !fine) return fine;
    list.edits_.emplace(id, true);
    return {};
  }

  Result<void> operator()(const Correction::Weight& weight) const {
    if (auto fine = check_agent(weight.agent); !fine) return fine;
    if (weight.weight < 1 || weight.weight > 1000) return refuse(Code::kBadRequest, "weight must be 1 to 1000");
    return {};
  }
};

Result<void> CorrectionCheck::take(const Correction& correction) {
  const auto& [revision, id, author, utime, content, what] = correction;
  if (revision <= revision_) return refuse(Code::kStale, "revisions must ascend, from 1");
  if (!is_kept_id(id)) return refuse(Code::kBadName, "an id must be one line of 1 to 80 bytes");
  if (!is_kept_author(author)) return refuse(Code::kBadName, "author must be one line of at most 80 bytes");
  if (utime < 0) return refuse(Code::kBadRequest, "a time before 1970");
  if (ids_.contains(id)) return refuse(Code::kExists, "another correction has the id " + id);
  if (auto fine = std::visit(Follow{*this, id}, what); !fine) return fine;
  revision_ = revision;
  ids_.insert(id);
  return {};
}

}  // namespace concord
