#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/brick_map.hpp"
#include "core/corrections.hpp"
#include "core/error.hpp"
#include "merge/edit_layer.hpp"
#include "merge/leases.hpp"

namespace concord {

/// Of placements that hold for no agent here, and are kept as history: those that a saved map has of other agents than
/// its layers.
inline constexpr std::int64_t kNobodys = -1;

/// All that people made: the fold of their corrections in the order of revisions. `check` says what a request leads to
/// or why it is refused, and changes nothing; `apply` takes a correction that was checked, and cannot fail. So what is
/// stored between the two can be had back by applying it all again, and gives the same.
class People {
 public:
  explicit People(double resolution) : resolution_(resolution), leases_(resolution) {}

  /// Of the last correction; 0 before the first.
  [[nodiscard]] std::int64_t revision() const { return made_.empty() ? 0 : made_.back().operation.revision; }

  /// `T_map_frame` places the request's frame in the map. Refused: what `evaluate` refuses (a move looks at `map`); a
  /// base revision that is to come (kBadRequest); one of its voxels was changed since (kStaleRevision); a voxel in
  /// another author's lease (kLocked).
  [[nodiscard]] Result<Correction::Edit> check(const EditRequest& request, const Transform& T_map_frame,
                                               const BrickMap& map, std::int64_t now) const;
  /// Of an edit, or of a placement: the last one that stands of an agent's frame and incarnation holds. Refused:
  /// kNotFound; kConflict if it is so already, or nothing is left of a placement; for an edit also a voxel in another
  /// author's lease (kLocked).
  [[nodiscard]] Result<Correction::Undo> check(const UndoRequest& request, std::int64_t now) const;
  /// Refused: a name that is taken (kExists) or nobody's (kNotFound), over kMaxZones (kTooLarge), beyond the map
  /// (kOutOfBounds), changed since the base revision (kStaleRevision), that being to come (kBadRequest); the zone's
  /// bounding box, before or after, overlaps that of another author's lease (kLocked).
  [[nodiscard]] Result<Correction::ZoneChange> check(const ZoneRequest& request, const Transform& T_map_frame,
                                                     std::int64_t now) const;

  /// Adds the bricks whose pins change to `touched`. @pre checked in this state; its revision is above all before.
  void apply(const Correction& correction, BrickSet& touched);

  /// A correction that was made, by its id.
  struct Made {
    Operation operation;        ///< `active` as it was then
    std::uint64_t content = 0;  ///< of the request; 0: not known, from a store of the first version
  };
  /// Null: none has this id.
  [[nodiscard]] const Made* find(const std::string& id) const;

  /// What matches, the oldest first.
  [[nodiscard]] std::vector<Operation> history(const HistoryRequest& request) const;

  [[nodiscard]] const EditLayer& edits() const { return edits_; }
  [[nodiscard]] const PinMap& pins() const { return edits_.pins(); }
  [[nodiscard]] const std::map<std::string, Zone>& zones() const { return zones_; }
  [[nodiscard]] const Leases& leases() const { return leases_; }
  [[nodiscard]] Leases& leases() { return leases_; }

  struct Placed {
    Correction::Placement placement;
    std::int64_t revision = 0;
    bool stands = true;  ///< it was not undone
  };
  /// By frame and incarnation: as it was placed, the last one last. Those of kNobodys are history only. Of an agent
  /// that had sent poses only (incarnation 0) they are over once it is placed with a layer.
  using Placements = std::map<std::pair<std::string, std::int64_t>, std::vector<Placed>>;
  /// By agent.
  [[nodiscard]] const std::map<std::string, Placements>& placements() const { return placements_; }
  /// Of an edit or a placement, whether it was not undone; none: neither has this id, or nothing is left of it.
  [[nodiscard]] std::optional<bool> stands(const std::string& id) const;
  /// Null: nobody placed it. Where an agent was placed by its poses its layer lies too, if it is in the same frame; but
  /// not a layer of a file, which tells where it lies itself.
  [[nodiscard]] const Transform* T_map_agent(const std::string& agent, const std::string& frame_id,
                                             std::int64_t incarnation) const;
  /// What makes it last that the layer of this incarnation lies where the agent's poses were placed: the same placement
  /// once more, now the layer's, by who made it. So it is over with this incarnation, when the agent is removed. None:
  /// the layer does not lie there because of that.
  [[nodiscard]] std::optional<Correction> carried_over(const std::string& agent, const std::string& frame_id,
                                                       std::int64_t incarnation, std::int64_t now) const;
  /// None: the site file's holds.
  [[nodiscard]] std::optional<int> weight(const std::string& agent) const;

 private:
  struct Apply;
  [[nodiscard]] Result<void> check_base(std::int64_t base_revision) const;
  [[nodiscard]] Result<void> check_target(const ZoneRequest& request, const Zone* zone, std::int64_t now) const;
  [[nodiscard]] bool is_active(const Operation& operation) const;
  [[nodiscard]] const Placed* placed(const std::string& agent, const std::string& frame_id,
                                     std::int64_t incarnation) const;
  [[nodiscard]] const Placed* placed_by_poses(const std::string& agent, const std::string& frame_id,
                                              std::int64_t incarnation) const;
  [[nodiscard]] std::string id_of_carried(std::int64_t revision) const;

  double resolution_;
  std::deque<Made> made_;  ///< in the order of their revisions
  std::map<std::string, std::size_t> by_id_;
  EditLayer edits_;
  std::map<std::string, Zone> zones_;
  std::map<std::string, Placements> placements_;
  std::map<std::string, int> weights_;
  Leases leases_;
};

}  // namespace concord
