#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/error.hpp"
#include "core/lattice.hpp"
#include "core/shape.hpp"
#include "core/text.hpp"
#include "core/transform.hpp"

namespace concord {

/// What people do to the map, and what that leads to. Requests are values the bus has already checked (names on the
/// whitelist, numbers finite, shapes checked, sizes capped); `id` is the asker's, and a request sent twice with one id
/// is done once. `utime` is when it was asked.

/// Of one edit: a wall of 20 m x 3 m takes 24,000 at 5 cm. More is several edits.
inline constexpr std::int64_t kMaxEditVoxels = 500'000;
inline constexpr std::size_t kMaxZones = 1000;
inline constexpr std::size_t kMaxLeases = 64;
/// Of a zone or a lease.
inline constexpr std::size_t kMaxVolumePoints = 64;
/// For a request that does not heed what was done since.
inline constexpr std::int64_t kAnyRevision = -1;

/// The frame that a person works in: the map's, or an agent's own (a headset's), which must then be aligned.
struct WorkFrame {
  std::string agent;     ///< empty: the map's frame
  std::string frame_id;  ///< the agent's frame as the asker knows it; empty: the present one
};

/// Pins voxels of the map, for good. `kMove` takes what is occupied in the shape, pins it free here and occupied there.
struct EditRequest {
  enum class Op { kAdd, kDelete, kMove };
  std::string id;
  std::string author;
  Op op = Op::kAdd;
  Shape shape;
  WorkFrame frame;
  Eigen::Vector3d move = Eigen::Vector3d::Zero();  ///< metres in `frame`; rounded to whole voxels of the map
  std::int64_t base_revision = kAnyRevision;       ///< refused if these voxels were changed since
  std::int64_t utime = 0;
  std::vector<std::string> known = {};  ///< edits that the asker knows of: while they hold they are no such change
};
inline constexpr std::size_t kMaxKnownEdits = 128;  ///< of one request

/// Takes an edit or a placement back, or brings it back.
struct UndoRequest {
  std::string id;
  std::string author;
  std::string edit_id;
  bool redo = false;
  std::int64_t utime = 0;
};

/// A volume that people fenced off, or opened to contact, for planning. Map data, not a rated safety function.
struct Zone {
  /// Ways through a costly zone cost more; ways beside all corridors, where there is one, much more.
  enum class Kind { kNoGo, kAllowContact, kCostly, kCorridor };
  static constexpr double kMaxMargin = 10.0;
  static constexpr int kMaxCost = 15;
  std::string name;  ///< is_title when it was made; unique
  Kind kind = Kind::kNoGo;
  Volume volume;
  Transform T_map_zone = Transform::Identity();
  std::string author;         ///< who last changed it
  std::int64_t utime = 0;     ///< when
  std::int64_t revision = 0;  ///< that this led to
  double margin = 0.0;        ///< metres around the volume, level, that it holds in as well; of no-go and costly zones
  int cost = 0;               ///< of costly zones: a metre costs so many more than one elsewhere, 1 to kMaxCost
};

/// Refused (kBadRequest): a margin or cost beyond its bounds, or of a kind of zone that has none.
[[nodiscard]] Result<void> check_terms(Zone::Kind kind, double margin, int cost);

struct ZoneRequest {
  enum class Op { kAdd, kChange, kDelete };
  std::string id;
  std::string author;
  Op op = Op::kAdd;
  std::string name;
  Zone::Kind kind = Zone::Kind::kNoGo;  ///< not heeded with kDelete, like the volume
  Volume volume;
  WorkFrame frame;
  std::int64_t base_revision = kAnyRevision;  ///< refused if the zone was changed since
  std::int64_t utime = 0;
  double margin = 0.0;  ///< see Zone; neither is heeded with kDelete
  int cost = 0;
};

/// A region that somebody works in; others are refused there until it ends.
struct Lease {
  std::string id;
  std::string author;
  Volume volume;
  Transform T_map_lease = Transform::Identity();
  std::int64_t until = 0;  ///< microseconds since 1970
};

/// Holding the same lease again renews it, and may move it.
struct LeaseRequest {
  std::string id;
  std::string author;
  std::string lease;  ///< its id, which its author shares with others
  bool hold = true;   ///< false: it is freed
  Volume volume;      ///< not heeded when it is freed
  WorkFrame frame;
  std::int64_t utime = 0;
};

/// Gives an agent another weight than the site file's.
struct WeightRequest {
  std::string id;
  std::string author;
  std::string agent;
  int weight = 1;  ///< 1 to 1000
  std::int64_t utime = 0;
};

/// A robot was seen at `utime`: its submap is placed so that it was there.
struct LocaliseRequest {
  std::string id;
  std::string author;
  std::string agent;
  Transform T_frame_base = Transform::Identity();
  WorkFrame frame;
  std::int64_t utime = 0;
};

/// One thing that a person did, whole: what the store and a saved map keep. Everything that people made is what their
/// corrections, taken in the order of their revisions, lead to.
struct Correction {
  /// An edit as it was evaluated: its voxels in the map's lattice, sorted and unique, none in both.
  struct Edit {
    EditRequest::Op op = EditRequest::Op::kAdd;
    std::vector<VoxelIndex> added;
    std::vector<VoxelIndex> deleted;
  };
  struct Undo {
    std::string edit_id;
    bool redo = false;
  };
  struct ZoneChange {
    ZoneRequest::Op op = ZoneRequest::Op::kAdd;
    Zone zone;  ///< as it is from now on; with kDelete just its name
  };
  /// Where an agent lies. It holds for one frame of one incarnation (modules/bus/stream.md): what was removed and comes
  /// again is not what was placed.
  struct Placement {
    std::string agent;
    std::string frame_id;
    std::int64_t incarnation = 0;
    bool has_layer = false;  ///< false: it had sent poses only
    Transform T_map_agent = Transform::Identity();
  };
  struct Weight {
    std::string agent;
    int weight = 1;
  };

  std::int64_t revision = 0;  ///< counts up with each correction, from 1
  std::string id;             ///< the asker's; an edit's id
  std::string author;
  std::int64_t utime = 0;     ///< when merge took it
  std::uint64_t content = 0;  ///< of the request: tells requests of one id apart
  std::variant<Edit, Undo, ZoneChange, Placement, Weight> what;
};

/// A correction in one line, as the history tells it.
struct Operation {
  enum class Kind {
    kAdd,
    kDelete,
    kMove,
    kUndo,
    kRedo,
    kZoneAdd,
    kZoneChange,
    kZoneDelete,
    kTransform,
    kWeight,
  };
  std::int64_t revision = 0;
  std::string id;
  std::string author;
  std::int64_t utime = 0;
  Kind kind = Kind::kAdd;
  std::string subject;     ///< the edit undone or redone, the zone, the agent; empty for an edit
  std::int64_t count = 0;  ///< voxels that an edit pins
  bool active = true;      ///< false for an edit or placement that is undone now
  VoxelIndex min, max;     ///< of what an edit pins
};

/// By its kind's number, as stores keep it: "zone_add".
inline constexpr std::array<std::string_view, 10> kOperationNames{
    "add", "delete", "move", "undo", "redo", "zone_add", "zone_change", "zone_delete", "transform", "weight"};
static_assert(kOperationNames.size() == static_cast<std::size_t>(Operation::Kind::kWeight) + 1);
[[nodiscard]] constexpr std::string_view name(Operation::Kind kind) {
  return kOperationNames[static_cast<std::size_t>(kind)];
}
[[nodiscard]] std::optional<Operation::Kind> operation_called(std::string_view name);
/// Whether it pins voxels.
[[nodiscard]] constexpr bool is_edit(Operation::Kind kind) { return kind <= Operation::Kind::kMove; }

/// @param active whether it is an edit that is not undone; true for anything else.
[[nodiscard]] Operation summary(const Correction& correction, bool active);

struct HistoryRequest {
  std::string id;
  std::string author;   ///< empty: anyone's
  std::string subject;  ///< an edit, zone or agent; empty: anything
  std::optional<Operation::Kind> kind;
  std::int64_t since = 0;  ///< microseconds since 1970; 0: ever
  std::int64_t until = 0;  ///< excluded; 0: ever
  std::int64_t after_revision = 0;
  int most = 1000;  ///< 1 to 10000; the oldest first
};

inline constexpr int kMostConflictRegions = 1'000;  ///< of one list

struct ConflictRequest {
  std::string id;
  int most = 100;  ///< 1 to kMostConflictRegions, those with the most conflicting voxels first
};

/// Conflicting voxels within one tile of the map, and what each agent says of them.
struct ConflictRegion {
  struct Claim {
    std::string agent;
    int occupied = 0;
    int free = 0;
  };
  VoxelIndex min, max;
  int voxels = 0;
  std::vector<Claim> claims;  ///< of agents that know any of them, in the order of their ids
};

}  // namespace concord
