#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "access/gate.hpp"
#include "access/token_bucket.hpp"
#include "core/transform.hpp"
#include "protocol/control.hpp"
#include "session/outbox.hpp"
#include "view/client_view.hpp"

namespace concord::hmd {

/// What clients may do in the long run and at once; told in the hello answer.
struct SessionLimits {
  double requests_per_second = 30, burst_requests = 100;
  double notices_per_second = 200, burst_notices = 400;
  double upload_bytes_per_second = 4e6, burst_upload_bytes = 16e6;
  double looks_per_second = 4, burst_looks = 20;  ///< frames of meshes or voxels: each is a look at the whole room
  double text_bytes_per_second = 1e6, burst_text_bytes = 8e6;
  /// Refusals of any kind; who goes on beyond is disconnected.
  double refusals_per_second = 10, burst_refusals = 100;
};

/// The answers given last, each with the frames that come before it, for who lost a connection and asks again under an
/// old id.
class RecentTexts {
 public:
  static constexpr std::size_t kMostBytes = 1 << 20;
  static constexpr std::size_t kMost = 256;
  /// Of all frames; with the oldest goes its answer, but never the latest one's.
  static constexpr std::size_t kMostFrameBytes = 8 << 20;

  struct Said {
    SharedText text;
    std::vector<FramePointer> frames;
  };
  void keep(std::int64_t id, SharedText text, std::vector<FramePointer> frames = {});
  /// Null: not kept.
  [[nodiscard]] const Said* find(std::int64_t id) const;

 private:
  void drop(std::deque<std::int64_t>::iterator which);

  std::map<std::int64_t, Said> said_;
  std::deque<std::int64_t> order_;
  std::size_t bytes_ = 0, frame_bytes_ = 0;
};

/// One client, also while its connection is lost.
struct Session {
  Session(std::int64_t number, std::string secret_text, Identity who, const SessionLimits& limits)
      : person(number),
        secret(std::move(secret_text)),
        identity(std::move(who)),
        requests(limits.requests_per_second, limits.burst_requests),
        notices(limits.notices_per_second, limits.burst_notices),
        uploads(limits.upload_bytes_per_second, limits.burst_upload_bytes),
        looks(limits.looks_per_second, limits.burst_looks),
        texts(limits.text_bytes_per_second, limits.burst_text_bytes) {}

  std::int64_t person;
  std::string secret;
  Identity identity;
  bool by_token = false;  ///< not from this machine
  std::string device;
  std::string address;
  std::string agent;     ///< that it is; empty: none
  std::string frame_id;  ///< of that agent's frame now

  bool tracking_lost = false;
  std::optional<Transform> T_own_head;
  std::optional<Eigen::Vector3d> pointer;  ///< in the same frame

  std::optional<std::int64_t> connection;  ///< nothing: lost since parked_at
  std::int64_t parked_at = 0;

  Outbox outbox;
  TokenBucket requests, notices, uploads, looks, texts;

  std::int64_t highest_id = 0;
  struct Pending {
    std::string name;
    std::vector<FramePointer> frames;  ///< that come before its answer
  };
  std::map<std::int64_t, Pending> pending;  ///< requests that wait for their answers, by id
  RecentTexts answered;

  std::map<std::uint32_t, ClientView> views;  ///< by stream
  struct Told {
    std::int64_t revision = -1, map_revision = -1;
    bool synced = false;
    bool operator==(const Told&) const = default;
  };
  std::map<std::uint32_t, Told> told_complete;
  std::int64_t told_skipped = 0;
  std::map<std::string, Frame> path_frames;  ///< robots whose paths it follows, and the frame it wants them in
  /// What it was told of a path last; it is said again each second.
  struct ToldPath {
    std::string id;
    std::int64_t plan_number = 0;
    std::string message;
    Eigen::Matrix4d T_map_frame;  ///< that its points were in
    bool operator==(const ToldPath&) const = default;
  };
  std::map<std::string, ToldPath> told_paths;  ///< by robot

  /// The region of stream 0 that it was told to have whole, and the revisions of that; nothing once it looks elsewhere.
  struct Whole {
    ViewRegion region;
    std::int64_t first, last;
  };
  std::optional<Whole> whole;
  /// What it still has of stream 0 since before its connection was lost.
  struct Kept {
    ViewRegion region;
    std::int64_t revision;
  };
  std::optional<Kept> kept;
};

}  // namespace concord::hmd
