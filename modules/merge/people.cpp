#include "merge/people.hpp"

#include <algorithm>
#include <cassert>

#include "core/map_archive.hpp"
#include "merge/edit_evaluation.hpp"
#include "merge/region.hpp"

namespace concord {
namespace {

bool matches(const Operation& operation, const HistoryRequest& request) {
  const auto concerns = [&](const std::string& subject) {
    return subject == operation.subject || (is_edit(operation.kind) && subject == operation.id);
  };
  return (request.author.empty() || operation.author == request.author) &&
         (request.subject.empty() || concerns(request.subject)) && (!request.kind || operation.kind == *request.kind) &&
         operation.utime >= request.since && (request.until == 0 || operation.utime < request.until);
}

/// The placement that was made so; null: it is none, or nothing is left of it.
template <class Placements>
auto* placement_made(Placements& of_agents, const Operation& operation) {
  decltype(&of_agents.begin()->second.begin()->second.front()) none = nullptr;
  if (operation.kind != Operation::Kind::kTransform) return none;
  const auto it = of_agents.find(operation.subject);
  if (it == of_agents.end()) return none;
  for (auto& [key, placements] : it->second) {
    const auto found = std::ranges::find(placements, operation.revision, &People::Placed::revision);
    if (found != placements.end()) return &*found;
  }
  return none;
}

}  // namespace

Result<Correction::Edit> People::check(const EditRequest& request, const Transform& T_map_frame, const BrickMap& map,
                                       std::int64_t now) const {
  if (const auto base = check_base(request.base_revision); !base) return tl::unexpected(base.error());
  auto edit = evaluate(request, T_map_frame, map, resolution_);
  if (!edit) return edit;
  const PinnedBricks bricks = by_brick(*edit);
  if (const auto room = edits_.check(bricks); !room) return tl::unexpected(room.error());
  if (request.base_revision >= 0 && edits_.changed_since(bricks, request.base_revision, request.known)) {
    return refuse(Code::kStaleRevision, "these voxels were changed since revision " +
                                            std::to_string(request.base_revision) + "; look at them, then ask again");
  }
  const auto free = leases_.check(bricks, request.author, now);
  if (!free) return tl::unexpected(free.error());
  return edit;
}

Result<Correction::Undo> People::check(const UndoRequest& request, std::int64_t now) const {
  Correction::Undo undo{request.edit_id, request.redo};
  if (const Made* made = find(request.edit_id);
      made != nullptr && made->operation.kind == Operation::Kind::kTransform) {
    const Placed* placed = placement_made(placements_, made->operation);
    if (placed == nullptr) {
      return refuse(Code::kConflict, "nothing is left of placement " + undo.edit_id + ": that frame is over");
    }
    if (placed->stands != undo.redo) return undo;
    return refuse(Code::kConflict, "placement " + undo.edit_id + (undo.redo ? " is not undone" : " is undone already"));
  }
  if (const auto can = edits_.check(undo); !can) return tl::unexpected(can.error());
  const auto free = leases_.check(edits_.bricks_of(request.edit_id), request.author, now);
  if (!free) return tl::unexpected(free.error());
  return undo;
}

Result<Correction::ZoneChange> People::check(const ZoneRequest& request, const Transform& T_map_frame,
                                             std::int64_t now) const {
  const auto it = zones_.find(request.name);
  const auto can = check_target(request, it != zones_.end() ? &it->second : nullptr, now);
  if (!can) return tl::unexpected(can.error());
  Zone zone;
  zone.name = request.name;
  if (request.op == ZoneRequest::Op::kDelete) return Correction::ZoneChange{request.op, std::move(zone)};
  const Eigen::AlignedBox3d bounds = bounds_in_map(request.volume, T_map_frame);
  const double edge = kMaxVoxel * resolution_;
  if (bounds.min().minCoeff() < -edge || bounds.max().maxCoeff() > edge) {
    return refuse(Code::kOutOfBounds, "zone " + request.name + " would lie beyond the map's bounds");
  }
  if (const auto free = leases_.check(bounds, request.author, now); !free) return tl::unexpected(free.error());
  zone.kind = request.kind;
  zone.volume = request.volume;
  zone.margin = request.margin;
  zone.cost = request.cost;
  zone.T_map_zone = T_map_frame;
  return Correction::ZoneChange{request.op, std::move(zone)};
}

/// @param zone the one that has this name; null: none.
Result<void> People::check_target(const ZoneRequest& request, const Zone* zone, std::int64_t now) const {
  if (request.op == ZoneRequest::Op::kAdd) {
    if (zone != nullptr) return refuse(Code::kExists, "a zone " + request.name + " exists; choose another name");
    if (zones_.size() < kMaxZones) return {};
    return refuse(Code::kTooLarge, "there are " + std::to_string(kMaxZones) + " zones already; delete some");
  }
  if (zone == nullptr) return refuse(Code::kNotFound, "no zone " + request.name);
  if (const auto base = check_base(request.base_revision); !base) return base;
  if (request.base_revision >= 0 && zone->revision > request.base_revision) {
    return refuse(Code::kStaleRevision, zone->author + " changed zone " + zone->name + " since; look at it first");
  }
  return leases_.check(bounds_in_map(zone->volume, zone->T_map_zone), request.author, now);
}

Result<void> People::check_base(std::int64_t base_revision) const {
  if (base_revision <= revision()) return {};
  return refuse(Code::kBadRequest, "base revision " + std::to_string(base_revision) + " is to come; it is " +
                                       std::to_string(revision()) + " now");
}

struct People::Apply {
  People& people;
  const Correction& correction;
  BrickSet& touched;

  void operator()(const Correction::Edit& edit) const {
    people.edits_.apply(correction.revision, correction.id, by_brick(edit), touched);
  }
  void operator()(const Correction::Undo& undo) const {
    if (people.edits_.contains(undo.edit_id)) return people.edits_.apply(correction.revision, undo, touched);
    const Made* made = people.find(undo.edit_id);
    Placed* placed = made != nullptr ? placement_made(people.placements_, made->operation) : nullptr;
    if (placed != nullptr) placed->stands = undo.redo;  // else its frame is over
  }
  void operator()(const Correction::ZoneChange& change) const {
    if (change.op == ZoneRequest::Op::kDelete) {
      people.zones_.erase(change.zone.name);
      return;
    }
    Zone& zone = people.zones_[change.zone.name];
    zone = change.zone;
    zone.author = correction.author;
    zone.utime = correction.utime;
    zone.revision = correction.revision;
  }
  void operator()(const Correction::Placement& placement) const {
    if (placement.incarnation == kNobodys) return;
    Placements& placements = people.placements_[placement.agent];
    if (placement.incarnation != 0) {
      std::erase_if(placements, [](const auto& entry) { return entry.first.second == 0; });
    }
    placements[{placement.frame_id, placement.incarnation}].push_back({placement, correction.revision});
  }
  void operator()(const Correction::Weight& weight) const { people.weights_[weight.agent] = weight.weight; }
};

void People::apply(const Correction& correction, BrickSet& touched) {
  assert(correction.revision > revision() && find(correction.id) == nullptr);
  std::visit(Apply{*this, correction, touched}, correction.what);
  by_id_[correction.id] = made_.size();
  made_.push_back({summary(correction, true), correction.content});
}

const People::Made* People::find(const std::string& id) const {
  const auto it = by_id_.find(id);
  return it != by_id_.end() ? &made_[it->second] : nullptr;
}

std::vector<Operation> People::history(const HistoryRequest& request) const {
  std::vector<Operation> out;
  const auto first = std::ranges::upper_bound(made_, request.after_revision, {},
                                              [](const Made& made) { return made.operation.revision; });
  for (auto it = first; it != made_.end() && out.size() < static_cast<std::size_t>(request.most); ++it) {
    if (!matches(it->operation, request)) continue;
    out.push_back(it->operation);
    out.back().active = is_active(it->operation);
  }
  return out;
}

bool People::is_active(const Operation& operation) const { return stands(operation.id).value_or(true); }

std::optional<bool> People::stands(const std::string& id) const {
  const Made* made = find(id);
  if (made == nullptr) return std::nullopt;
  if (is_edit(made->operation.kind)) return edits_.is_active(id);
  const Placed* placed = placement_made(placements_, made->operation);
  return placed != nullptr ? std::optional(placed->stands) : std::nullopt;
}

const Transform* People::T_map_agent(const std::string& agent, const std::string& frame_id,
                                     std::int64_t incarnation) const {
  const Placed* found = placed_by_poses(agent, frame_id, incarnation);
  if (found == nullptr) found = placed(agent, frame_id, incarnation);
  return found != nullptr ? &found->placement.T_map_agent : nullptr;
}

const People::Placed* People::placed(const std::string& agent, const std::string& frame_id,
                                     std::int64_t incarnation) const {
  const auto it = placements_.find(agent);
  if (it == placements_.end()) return nullptr;
  const auto found = it->second.find({frame_id, incarnation});
  if (found == it->second.end()) return nullptr;
  const auto last = std::ranges::find(found->second.rbegin(), found->second.rend(), true, &Placed::stands);
  return last != found->second.rend() ? &*last : nullptr;
}

/// What an agent's layer takes over from before it had one. It is later than any placement of a layer, see apply.
const People::Placed* People::placed_by_poses(const std::string& agent, const std::string& frame_id,
                                              std::int64_t incarnation) const {
  const bool is_of_a_robot = incarnation > 0 && incarnation < kLoadedIncarnation;
  return is_of_a_robot ? placed(agent, frame_id, 0) : nullptr;
}

std::optional<Correction> People::carried_over(const std::string& agent, const std::string& frame_id,
                                               std::int64_t incarnation, std::int64_t now) const {
  const Placed* before = placed_by_poses(agent, frame_id, incarnation);
  if (before == nullptr) return std::nullopt;
  const auto made =
      std::ranges::lower_bound(made_, before->revision, {}, [](const Made& one) { return one.operation.revision; });
  assert(made != made_.end() && made->operation.revision == before->revision);
  Correction out{revision() + 1,   id_of_carried(before->revision), made->operation.author, now, made->content,
                 before->placement};
  auto& placement = std::get<Correction::Placement>(out.what);
  placement.incarnation = incarnation;
  placement.has_layer = true;
  return out;
}

/// One that no person has used.
std::string People::id_of_carried(std::int64_t revision) const {
  const std::string first = "carried-" + std::to_string(revision);
  std::string id = first;
  for (int i = 1; find(id) != nullptr; ++i) id = first + "." + std::to_string(i);
  return id;
}

std::optional<int> People::weight(const std::string& agent) const {
  const auto it = weights_.find(agent);
  return it != weights_.end() ? std::optional(it->second) : std::nullopt;
}

}  // namespace concord
