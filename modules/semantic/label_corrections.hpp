#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/corrections.hpp"
#include "core/lattice.hpp"

namespace concord {

/// What people say of parts of the map. Like edits: everything is a list of corrections in the order of their revisions,
/// and what holds is their fold. Nothing is ever taken out of the list; taking back is a correction too.

/// Classes count from 1 as they are named first; instances of a class count from 1. No number is given twice.
using ClassId = std::uint32_t;
struct InstanceId {
  ClassId label = 0;
  std::uint32_t instance = 0;
  auto operator<=>(const InstanceId&) const = default;
};

inline constexpr std::size_t kMaxClasses = 4096;
inline constexpr std::size_t kMaxInstances = 65'000;       ///< ever
inline constexpr std::int64_t kMaxLabelVoxels = 500'000;   ///< of one label, as of one edit
inline constexpr std::int64_t kMaxAllLabelVoxels = 50'000'000;

struct LabelCorrection {
  /// Claims voxels of the map's lattice. The later claim has a voxel.
  struct Claim {
    InstanceId of;
    std::string class_name;  ///< of a class that this one names first; else empty
    std::vector<VoxelIndex> voxels;  ///< sorted and unique
    std::string edit_id;     ///< the edit it came with (an injected asset): it holds while that edit does; else empty
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

/// A class's name is a title (is_title).
struct LabelRequest {
  enum class Op { kLabel, kRename, kReassign, kTakeOff, kUndo, kRedo };
  std::string id;
  std::string author;
  Op op = Op::kLabel;
  std::string name;       ///< of the class; kReassign: of the class it goes to
  InstanceId of;          ///< kLabel: instance 0 makes a new one; kTakeOff: instance 0 means all
  std::uint32_t to_instance = 0;     ///< kReassign: 0 makes a new one
  std::vector<VoxelIndex> voxels;    ///< kLabel: map lattice, sorted and unique
  std::string correction_id;         ///< kUndo, kRedo
  std::string edit_id;               ///< kLabel: see Claim
  std::int64_t utime = 0;
};

}  // namespace concord
