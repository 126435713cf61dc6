#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/lattice.hpp"
#include "core/text.hpp"
#include "core/transform.hpp"

namespace concord {

/// What people, robots and programs ask for, beside corrections (core/corrections.hpp). Each is a value the bus has
/// already checked (names on the whitelist, numbers finite, sizes capped); `id` is the asker's, and a request sent
/// twice with one id is done once.

/// Puts an agent's submap into the map.
struct TransformRequest {
  std::string id;
  std::string author;
  std::string agent;
  std::string frame_id;  ///< the agent's frame it was found for; empty: the present one
  Transform T_map_agent = Transform::Identity();
  std::int64_t utime = 0;  ///< when it was asked
};

/// Ends what an agent has sent: `kReset` keeps the agent and waits for a new frame, `kRemove` forgets it.
struct AgentRequest {
  enum class Op { kReset, kRemove };
  std::string id;
  std::string agent;
  Op op = Op::kReset;
};

/// Asks for one point per occupied cell of `resolution`, as SLAM-XR's downsampler service does.
struct DownsampleRequest {
  std::string id;
  std::string agent;
  double resolution = 0.5;  ///< metres
};

/// Saving, listing and loading of maps. `kLoad` makes the file one more agent called `agent`.
struct MapRequest {
  enum class Op { kSave, kList, kLoad };
  std::string id;
  Op op = Op::kSave;
  std::string map;  ///< name without extension
  /// "bt", "ot" or "concord". kSave: each once, all are written or none; kLoad: one, or none: whichever exists.
  std::vector<std::string> formats;
  bool overwrite = false;
  std::string agent;       ///< with kLoad; empty: the map's name
  std::int64_t utime = 0;  ///< when it was asked

  [[nodiscard]] bool names(const std::string& format) const { return std::ranges::count(formats, format) > 0; }
};

inline constexpr std::size_t kMaxWaypoints = 1000;
inline constexpr std::size_t kMaxFootprintCorners = 64;

/// Asks for a path on the grid. With `keep_active` it is replanned whenever a change of the map touches it. `kCancel`
/// ends what is kept or waits for the robot; nothing else is heeded then.
struct PathRequest {
  enum class Op { kPlan, kCancel };
  std::string id;
  std::string robot;
  std::optional<Eigen::Vector2d> start;  ///< map frame; absent: the robot's last pose
  Eigen::Vector2d goal = Eigen::Vector2d::Zero();
  double radius = 0.0;  ///< robot radius; 0: the site file's for this robot
  bool keep_active = false;
  std::vector<Eigen::Vector2d> waypoints;  ///< to pass on the way, in this order; at most kMaxWaypoints
  Op op = Op::kPlan;
  /// Corners, robot frame; none: the site file's, if it has any. What follows is heeded for a footprint alone.
  std::vector<Eigen::Vector2d> footprint;
  double turn_radius = 0.0;        ///< with `footprint`; 0: it turns in place
  double start_yaw = 0.0;          ///< of a given start
  std::optional<double> goal_yaw;  ///< absent: any
};

/// Asks for a robot's kept path in an agent's frame.
struct PathWatch {
  std::string id;
  std::string robot;        ///< empty: all robots'
  std::string frame_agent;  ///< in whose frame
};

/// Where a robot is in its own frame.
struct AgentPose {
  std::string agent;
  std::string frame_id;
  Transform T_agent_base = Transform::Identity();
  std::int64_t utime = 0;
};

/// The answer to any request; the map revision it led to where there is one.
struct Answer {
  std::string id;
  std::string process;
  bool ok = false;
  std::string code;     ///< "OK" or a Code's name
  std::string message;  ///< for a person
  std::int64_t revision = 0;
  std::int64_t count = 0;                ///< voxels, bytes or items concerned
  std::uint64_t content = 0;             ///< of a map that was saved: digest of its voxels
  std::vector<std::int64_t> parts = {};  ///< of a map that was saved: bytes of each format, as they were asked for
};

/// What is known of one point of a path.
struct PathPoint {
  double yaw = 0.0;        ///< where the path goes on to, at the last point as before it; of a footprint its heading
  double clearance = 0.0;  ///< metres to an occupied or unknown cell
  std::int32_t leg = 0;    ///< that ends there or beyond
  double eta = 0.0;        ///< seconds from the start
};

/// The planner's word on one path request; `points` is empty unless status is "OK".
struct Path {
  std::string id;
  std::string robot;
  std::string status;                   ///< "OK" or a reason, see planner/README.md
  std::string message;                  ///< for a person
  std::vector<Eigen::Vector3d> points;  ///< z on the floor of the band
  double length = 0.0;
  double least_clearance = 0.0;
  std::int64_t map_revision = 0;
  std::int64_t plan_number = 0;  ///< counts up with each replanning of one request
  bool active = false;
  std::int64_t utime = 0;
  std::vector<PathPoint> details;  ///< of each point
  std::int64_t path_id = 0;        ///< no two of one planner's are alike
  std::int64_t superseded = 0;     ///< path_id of the path whose place it took; 0: none
  std::string edit_id;             ///< that cut the way off, where it is known
  std::string frame_agent;         ///< in whose frame the points are; empty: the map's
  std::string frame_id;
  double radius = 0.0;                     ///< of the disc that was planned for, or around the footprint, metres
  std::vector<Eigen::Vector2d> footprint;  ///< that was planned for, robot frame; none: a disc
  double turn_radius = 0.0;                ///< with it
  double zmin = 0.0, zmax = 0.0;           ///< heights of its band
  std::int32_t failed_leg = -1;
  std::optional<Eigen::Vector2d> nearest;  ///< what can be reached nearest to a goal that cannot
  std::vector<std::string> zones;          ///< no-go zones near it
};

/// What is known of one agent; published by merge for people and headsets.
struct AgentState {
  std::string id;
  std::string kind;
  std::string frame_id;
  int weight = 1;
  bool aligned = false;
  Transform T_map_agent = Transform::Identity();
  std::int64_t known = 0;
  std::int64_t occupied = 0;
  std::int64_t revision = 0;
  bool synced = false;  ///< all that its stream has announced has arrived
};

}  // namespace concord
