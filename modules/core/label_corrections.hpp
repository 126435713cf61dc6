#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "core/corrections.hpp"
#include "core/lattice.hpp"
#include "core/log_odds.hpp"

namespace concord {

/// What people say of parts of the map. Like edits: everything is a list of corrections in the order of their
/// revisions, and what holds is their fold. Nothing is ever taken out of the list; taking back is a correction too.

/// Classes count from 1 as they are named first; instances of a class count from 1. No number is given twice.
using ClassId = std::uint32_t;
struct InstanceId {
  ClassId label = 0;
  std::uint32_t instance = 0;
  auto operator<=>(const InstanceId&) const = default;
};

inline constexpr std::size_t kMaxClasses = 4096;
inline constexpr std::size_t kMaxInstances = 65'000;              ///< ever
inline constexpr std::int64_t kMaxLabelVoxels = 500'000;          ///< of one label, as of one edit
inline constexpr std::int64_t kMaxAllLabelVoxels = 50'000'000;    ///< of labels that are not undone, but for models
inline constexpr std::int64_t kMaxLabelVoxelsEver = 100'000'000;  ///< of all
/// Of all labels ever, each counting its own: what memory they take. Voxels that stand apart take a brick each.
inline constexpr std::int64_t kMaxLabelBricks = 4'000'000;
inline constexpr std::size_t kMaxLabelCorrections = 1'000'000;  ///< ever, that people may make

/// What a label lies on: the frame of an agent, with which it moves, or the map.
struct LabelAnchor {
  std::string agent;     ///< empty: the map
  std::string frame_id;  ///< the agent's; in another one it is not what was labelled
  Transform T_map_agent = Transform::Identity();
};

/// A model as it was put into the map.
struct Injection {
  std::string asset;
  Transform T_map_asset = Transform::Identity();
  std::string replaces;  ///< the edit that had put it elsewhere before, and is undone while this one holds; else empty
};

struct LabelCorrection {
  /// Claims voxels of the map's lattice, as they lay then. The later claim has a voxel.
  struct Claim {
    InstanceId of;
    std::string class_name;          ///< of a class that this one names first; else empty
    std::vector<VoxelIndex> voxels;  ///< sorted and unique
    std::string edit_id = {};  ///< the edit it came with (an injected asset): it holds while that edit does; else empty
    LabelAnchor anchor = {};
    Injection injection = {};  ///< what that edit put there; not heeded without one
  };
  struct Rename {
    ClassId label = 0;
    std::string name;
  };
  /// All that was claimed for one instance until now is the other's.
  struct Reassign {
    InstanceId from, to;
  };
  /// What was claimed for an instance until now, or for all instances of a class (instance 0), is claimed no more. What
  /// was claimed below it shows again.
  struct TakeOff {
    InstanceId of;
  };
  struct Undo {
    std::string correction_id;
    bool redo = false;
  };

  std::int64_t revision = 0;
  std::string id;  ///< the asker's
  std::string author;
  std::int64_t utime = 0;
  std::uint64_t content = 0;  ///< of the request
  std::variant<Claim, Rename, Reassign, TakeOff, Undo> what;
};

/// What people ask of the labels. A class's name is a title (is_title). Names and numbers that an operation does not
/// heed may be anything.
struct LabelRequest {
  enum class Op {
    kLabel,     ///< what is occupied in `shape` is an instance of the class `name`; a new one if `of.instance` is 0
    kRestore,   ///< the same with the numbers `of`, as a saved cloud has them
    kRename,    ///< the class `of.label` is called `name`
    kReassign,  ///< the instance `of` is one of the class `name`; a new one if `to_instance` is 0
    kTakeOff,   ///< the label comes off the instance `of`, or off all of its class (instance 0); the voxels stay
    kDelete,    ///< the voxels of `of` are deleted from the map, by one edit with this request's id
    kUndo,      ///< of the label correction `correction_id`
    kRedo,
    kTouch,  ///< kLabel, of the object that is touched in the middle of `shape`
  };
  std::string id;
  std::string author;
  Op op = Op::kLabel;
  std::string name;
  InstanceId of;
  std::uint32_t to_instance = 0;
  std::string correction_id;
  Shape shape;
  WorkFrame frame;
  std::int64_t utime = 0;
};

struct LabelQuery {
  enum class Kind {
    kAll,
    kAt,       ///< the instance at a point
    kClass,    ///< all instances of a class
    kWithin,   ///< instances with a voxel's centre within a distance of a point
    kBorder,   ///< of a class: the free voxels that share a face with each instance
    kClasses,  ///< all that were named, be it that nothing of them shows: as instances 0
  };
  std::string id;
  Kind kind = Kind::kAll;
  std::string name;  ///< of the class
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();
  double radius = 0.0;  ///< metres, at most 100
};

/// An instance as it shows in the map (or what it borders): where, and how much of it.
struct LabelInstance {
  InstanceId of;
  std::string name;
  std::int64_t voxels = 0;
  VoxelIndex min, max;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< metres, map frame
  std::string asset = {};                              ///< that it is; empty: none
  Transform T_map_asset = Transform::Identity();       ///< of an asset: where its model lies
};

/// Of values that are not kUnknown.
inline constexpr std::int32_t kMaxLabelSlots = 65'535;
[[nodiscard]] constexpr LogOdds value_of_slot(std::int32_t slot) { return static_cast<LogOdds>(slot - 32767); }
[[nodiscard]] constexpr std::int32_t slot_of_value(LogOdds value) { return value + 32767; }

/// What a value of the label stream means: a voxel of `out/labels` holds value_of_slot(slot).
struct LabelSlot {
  std::int32_t slot = 0;
  InstanceId of;
  std::string name;
  bool operator==(const LabelSlot&) const = default;
};

}  // namespace concord
