#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "core/brick_set.hpp"
#include "core/error.hpp"
#include "core/label_corrections.hpp"
#include "semantic/brick_masks.hpp"

namespace concord {

/// What is labelled: the fold of label corrections. `check` says what a request leads to or why it is refused, and
/// changes nothing; `apply` takes what was checked, and cannot fail.
///
/// A label costs what its own bricks cost, however many there are.
class Labels {
 public:
  using What = decltype(LabelCorrection::what);

  /// @param resolution of the map, metres.
  explicit Labels(double resolution) : resolution_(resolution) {}

  [[nodiscard]] std::int64_t revision() const { return made_.empty() ? 0 : made_.back().revision; }

  /// Refused: a name that is none (kBadName) or another class's (kExists); a class, instance or correction that is not
  /// there (kNotFound); no voxel (kEmpty); voxels out of bounds (kOutOfBounds); an undo of what is undone, or what
  /// would leave two classes with one name (kConflict); over a cap (kTooLarge).
  /// @param voxels what a kLabel, kTouch or kRestore selects; sorted and unique. @pre not kDelete.
  [[nodiscard]] Result<What> check(const LabelRequest& request, const std::vector<VoxelIndex>& voxels) const;

  /// Whether a correction from outside (a map file) is one, and may be the next. Refused: as by `check`; a revision
  /// that is not above the last one's (kStale), an id that was there (kExists), texts that are none (kBadName), voxels
  /// that are not sorted and unique, numbers that are none (kBadRequest), an anchor's transform that is none
  /// (kBadTransform).
  [[nodiscard]] Result<void> follows(const LabelCorrection& correction) const;

  /// Adds the bricks whose labels may change to `touched`. @pre checked in this state; the revision is above all
  /// before.
  void apply(const LabelCorrection& correction, BrickSet& touched);

  /// How an edit is that claims came with.
  struct EditState {
    bool active = false;
    std::int64_t revision = 0;  ///< merge's, that made it so
    bool by_us = false;         ///< semantic asked for that
  };
  /// Merge's word. What nothing was said of does not hold.
  void set_edit(const std::string& edit_id, const EditState& state, BrickSet& touched);

  /// Whether some claim came with this edit; whether merge has said if it holds.
  [[nodiscard]] bool is_edit_of_claim(const std::string& edit_id) const { return by_edit_.contains(edit_id); }
  [[nodiscard]] bool knows_edit(const std::string& edit_id) const { return edits_.contains(edit_id); }

  /// A model that was put into the map.
  struct Injected {
    std::string request_id, edit_id, author;
    InstanceId of;
    Injection what;
    std::optional<EditState> edit;  ///< none: merge has said nothing of it
    std::int64_t count = 0;         ///< voxels
  };
  /// By the ids of the edits; those that merge refused are none.
  [[nodiscard]] std::vector<Injected> injected() const;
  /// Another after whatever may change that, but for what merge says of the edits.
  [[nodiscard]] std::int64_t injected_revision() const { return injected_revision_; }
  /// Voxels of all models that came in the place of others, ever: what moves have spent of kMaxLabelVoxelsEver.
  [[nodiscard]] std::int64_t moved_voxels() const { return moved_voxels_; }

  /// An agent's frame lies there now: the labels on it go along, be they claimed before or after; those of before when
  /// `lay_some` comes to them. What nothing was said of lies where it was claimed.
  void place(const LabelAnchor& where);

  /// Lays claims whose frame lies elsewhere now, until about so many voxels were laid; at least one. Those that do not
  /// hold are laid when they do. Returns whether there are more.
  bool lay_some(std::int64_t voxels, BrickSet& touched);

  /// Whether `place` would say something new of claims that there are.
  [[nodiscard]] bool is_news(const LabelAnchor& where) const;

  /// A claim whose edit merge has said nothing of.
  struct Waiting {
    std::string request_id, edit_id, author;
    std::int64_t utime = 0;
    std::vector<VoxelIndex> voxels;  ///< sorted
  };
  /// At most so many; those that are undone wait for nothing.
  [[nodiscard]] std::vector<Waiting> waiting(std::size_t most) const;
  [[nodiscard]] std::optional<Waiting> waiting_for(const std::string& edit_id) const;

  struct Made {
    std::string id, author;
    std::int64_t utime = 0;
    std::int64_t revision = 0;
    std::uint64_t content = 0;
    InstanceId of;           ///< of a claim or reassignment: what it led to
    std::int64_t count = 0;  ///< voxels of a claim
  };
  /// Null: no correction has this id.
  [[nodiscard]] const Made* find(const std::string& id) const;

  /// Whose a claim is, be its edit there or not; nothing if it is undone or taken off, or no claim.
  [[nodiscard]] std::optional<InstanceId> owner_of(const std::string& claim_id) const;

  /// Which model it is, if it is one that lies in the map, and where: of one on its way, where it was put last.
  [[nodiscard]] std::optional<Injection> model_of(InstanceId of) const;

  [[nodiscard]] std::optional<InstanceId> at(VoxelIndex voxel) const;

  struct Share {
    InstanceId of;
    VoxelMask voxels;
  };
  /// What is claimed of these voxels of a brick, by ascending instance; no voxel twice.
  [[nodiscard]] std::vector<Share> shares(BrickIndex index, const VoxelMask& of_these) const;

  struct Class {
    std::string name;
    std::set<std::uint32_t> given;  ///< numbers of instances, ever
    [[nodiscard]] std::uint32_t highest() const { return given.empty() ? 0 : *given.rbegin(); }
  };
  [[nodiscard]] const std::map<ClassId, Class>& classes() const { return classes_; }
  [[nodiscard]] std::optional<ClassId> class_called(const std::string& name) const;

  /// The bricks in which something was ever claimed for an instance; where it may be now.
  [[nodiscard]] BrickSet bricks_of(InstanceId of) const;
  [[nodiscard]] std::vector<BrickIndex> sorted_bricks() const;

 private:
  struct Step {
    LabelCorrection::Claim claim;                           ///< without its voxels
    std::vector<std::pair<BrickIndex, VoxelMask>> claimed;  ///< as it lay then; none if it lies so now
    std::vector<std::pair<BrickIndex, VoxelMask>> bricks;   ///< where it lies now
    What what = LabelCorrection::TakeOff{};                 ///< not heeded for a claim
    bool is_claim = false;
    bool active = true;
    bool is_astray = false;  ///< its frame lies elsewhere since it was laid
    bool is_queued = false;  ///< to be laid
  };

  struct Apply;
  struct Follow;
  [[nodiscard]] Result<void> check_voxels(const std::vector<VoxelIndex>& voxels) const;
  [[nodiscard]] Result<void> check_room(InstanceId of) const;
  [[nodiscard]] Result<What> check_claim(const LabelRequest& request, const std::vector<VoxelIndex>& voxels) const;
  [[nodiscard]] Result<LabelCorrection::Claim> numbered(const LabelRequest& request) const;
  [[nodiscard]] Result<LabelCorrection::Claim> restored(const LabelRequest& request) const;
  [[nodiscard]] Result<What> check_rename(const LabelRequest& request) const;
  [[nodiscard]] Result<What> check_reassign(const LabelRequest& request) const;
  [[nodiscard]] Result<What> check_take_off(const LabelRequest& request) const;
  [[nodiscard]] Result<What> check_undo(const LabelRequest& request) const;
  [[nodiscard]] Result<void> check_instance(InstanceId of) const;
  [[nodiscard]] Result<void> check_new_name(const std::string& name) const;
  /// Whose a claim is now; nothing if it is undone or taken off.
  [[nodiscard]] std::optional<InstanceId> owner_of(std::uint32_t step) const;
  /// The same; nothing either if the edit that it came with does not hold.
  [[nodiscard]] std::optional<InstanceId> holder_of(std::uint32_t step) const;
  [[nodiscard]] std::map<ClassId, std::string> names_if(std::uint32_t step, bool active) const;
  void touch(InstanceId of, BrickSet& touched) const;
  /// It, and all that was ever reassigned to it.
  [[nodiscard]] std::set<InstanceId> with_sources(InstanceId of) const;
  void enter_bricks(std::uint32_t step, BrickSet& touched);
  void leave_bricks(std::uint32_t step, BrickSet& touched);
  void lay(std::uint32_t step, const Transform& T_map_agent, BrickSet& touched);
  void lay_if_astray(std::uint32_t step, BrickSet& touched);
  [[nodiscard]] bool holds(std::uint32_t step) const;
  void give(InstanceId of);

  double resolution_;
  std::deque<Made> made_;
  std::map<std::string, std::uint32_t> by_id_;  ///< index into made_ and steps_
  std::deque<Step> steps_;
  std::map<ClassId, Class> classes_;
  std::map<InstanceId, std::vector<std::uint32_t>> claims_;   ///< steps, ascending; by whom they were made for
  std::map<InstanceId, std::vector<std::uint32_t>> changes_;  ///< TakeOff and Reassign, by what they concern
  std::map<InstanceId, std::set<InstanceId>> sources_;        ///< what was ever reassigned to it
  std::deque<std::uint32_t> to_lay_;
  std::map<std::string, std::vector<std::uint32_t>> by_edit_;
  std::set<std::string> unsaid_;  ///< of by_edit_: those that merge has said nothing of
  std::map<std::string, EditState> edits_;
  struct Frame {
    std::vector<std::uint32_t> claims;     ///< on it
    std::optional<Transform> T_map_agent;  ///< as was last said
  };
  std::map<std::pair<std::string, std::string>, Frame> frames_;  ///< by agent and frame_id
  std::vector<std::uint32_t> renames_;
  std::unordered_map<BrickIndex, std::vector<std::uint32_t>, IndexHash> by_brick_;  ///< claims not undone, ascending
  std::size_t instances_ = 0;
  std::int64_t voxels_ = 0, voxels_ever_ = 0;  ///< of claims not undone that came with no edit; of all
  std::int64_t bricks_ever_ = 0, moved_voxels_ = 0, injected_revision_ = 0;
};

}  // namespace concord
