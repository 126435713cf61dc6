#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/brick_map.hpp"
#include "core/octomap_format.hpp"
#include "core/scan.hpp"

namespace concord {

/// What an agent's present layer was made of.
enum class Source { kStream, kOctomap, kClouds, kFile };

/// Clouds are counted from 0 in each start of their sender.
struct CloudNumber {
  std::int64_t boot_id = 0;  ///< greater than that of every earlier start
  std::int64_t sequence = 0;
};

/// One agent's claim about space, in its own frame.
struct Agent {
  std::int64_t incarnation = 0;  ///< unlike that of an agent that had its id and was removed
  std::string frame_id;
  Source source = Source::kStream;
  CloudNumber next_cloud;                ///< in this frame; earlier ones of the same start are duplicates
  std::int64_t last_cloud = 0;           ///< when one was taken, microseconds; 0: not since this process started
  std::vector<std::string> dead_frames;  ///< frames that were reset, the latest last
  BrickMap layer;

  [[nodiscard]] std::int64_t known() const { return static_cast<std::int64_t>(layer.known_count()); }
};

/// What a message did to a layer.
struct Change {
  bool new_frame = false;          ///< a frame began: every brick of the one before is void
  std::vector<BrickIndex> bricks;  ///< changed or emptied since, ascending
};

/// What a cloud did. Clouds are numbered, so that lost ones and those that came twice are known.
struct CloudChange {
  Change change;
  std::int64_t lost = 0;    ///< clouds missing before this one
  bool duplicate = false;   ///< it was not taken: this one or a later one has been
  std::size_t skipped = 0;  ///< points left out: not finite or out of bounds
};

/// Every agent's layer, as received. Pure: no messages, no files, no clock.
///
/// An agent is made by the first content taken for it. A new frame_id voids what was there, whichever way it came:
/// of two senders in different frames the newest wins. Within one frame a brick stream has the last word (it voids
/// octomap and clouds, and they are refused after it); an octomap replaces all, clouds add to what is there.
class Ingest {
 public:
  struct Config {
    double resolution = 0.05;  ///< of all layers, metres
    std::int64_t max_agents = 64;
    std::int64_t max_known_voxels = 400'000'000;  ///< per agent
    std::int64_t start = 0;                       ///< of this process, microseconds since 1970
  };
  /// After this without a cloud an older boot_id is believed: the robot's clock went back. Microseconds.
  static constexpr std::int64_t kBootSilence = 3'000'000;
  /// Resets that an agent's memory holds; older dead frames are forgotten.
  static constexpr std::size_t kMaxDeadFrames = 64;

  explicit Ingest(Config config) : config_(config), last_incarnation_(config.start) {}

  /// Whether content of this frame is taken from this source now. Refused: kBadName, kTooLarge (too many agents),
  /// kBadFrame (the frame was reset, or is no name), kBadRequest (the frame belongs to a brick stream), kExists (a file
  /// never goes into an agent that is there).
  [[nodiscard]] Result<void> admit(const std::string& id, const std::string& frame_id, Source source) const;
  /// Whether this frame of the agent was reset: its sender must begin another.
  [[nodiscard]] bool is_over(const std::string& id, const std::string& frame_id) const;

  /// A brick stream begins in this frame. Whatever was there is void.
  [[nodiscard]] Result<Change> begin_stream(const std::string& id, const std::string& frame_id);
  /// A brick of the stream that began. True if it changed the layer. @pre begin_stream(id, ...) was the last source.
  [[nodiscard]] Result<bool> set_brick(const std::string& id, BrickIndex index, Brick brick);

  /// A whole octomap replaces the layer; bricks that stayed the same are not touched. Resampled if it must be.
  [[nodiscard]] Result<Change> take_octomap(const std::string& id, const std::string& frame_id, ByteSpan data,
                                            OctomapFormat format, double resolution);

  /// Adds a cloud to the layer. A full layer takes none; the one that fills it may go beyond. A greater boot_id begins
  /// the numbers anew. Refused: kStale (of an earlier start of the sender), and what scan.hpp refuses.
  [[nodiscard]] Result<CloudChange> take_cloud(const std::string& id, const std::string& frame_id, CloudNumber number,
                                               Scan scan, std::int64_t now);

  /// The agent as a reset leaves it: without content, its frame over until the robot starts another.
  /// Refused: kNoAgent. Given to `put` once it is safe.
  [[nodiscard]] Result<Agent> after_reset(const std::string& id) const;
  /// A saved map (`.bt` or `.ot`) as a new agent. Refused: kExists, and what octomap_reader.hpp refuses.
  [[nodiscard]] Result<Agent> from_file(const std::string& id, const std::string& map, ByteSpan file) const;
  /// The agents of a native map file, by ascending id, each in its frame and with the incarnation that
  /// loaded_incarnation states. Refused: kExists if any of them is there, kTooLarge, and what read_map_archive refuses.
  [[nodiscard]] Result<std::vector<std::pair<std::string, Agent>>> from_archive(ByteSpan file,
                                                                                const std::string& request_id) const;

  /// Makes the agent be this. @pre `agent` came from after_reset, from_file, from_archive or from disk.
  Change put(const std::string& id, Agent agent);
  /// @pre the agent exists.
  void remove(const std::string& id) { agents_.erase(id); }

  [[nodiscard]] const Agent* find(const std::string& id) const;
  /// Known voxels of the agents that a request has loaded (see loaded_incarnation); nullopt if none of them is there.
  [[nodiscard]] std::optional<std::int64_t> loaded(std::int64_t incarnation) const;
  [[nodiscard]] const std::map<std::string, Agent>& agents() const { return agents_; }
  [[nodiscard]] const Config& config() const { return config_; }

 private:
  Agent& enter(const std::string& id, const std::string& frame_id, Source source, Change& change);

  Config config_;
  std::int64_t last_incarnation_;
  std::map<std::string, Agent> agents_;
};

}  // namespace concord
