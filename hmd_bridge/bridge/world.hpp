#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridge/label_copy.hpp"
#include "bridge/things.hpp"
#include "bus/brick_stream.hpp"
#include "bus/list_stream.hpp"
#include "bus/messages_map.hpp"
#include "bus/process.hpp"
#include "session/hub.hpp"

namespace concord::hmd {

/// A copy of one brick stream, as clients see it: a layer of the hub. The bricks themselves are kept where they are
/// needed.
class LayerCopy {
 public:
  struct Config {
    std::string stream;        ///< on the bus
    std::uint32_t number = 0;  ///< for clients
    bool keep = false;         ///< whether map() is kept
    /// What of a brick is shown.
    std::function<VoxelMask(const Brick&)> shown;
    /// A second layer from the same bricks: the free cells of a grid.
    std::optional<std::uint32_t> second;
    std::function<VoxelMask(const Brick&)> shown_second;
    int levels = kLevels;
  };
  LayerCopy(const NodeContext& context, Hub& hub, Config config);
  LayerCopy(const LayerCopy&) = delete;
  LayerCopy& operator=(const LayerCopy&) = delete;
  ~LayerCopy();

  /// Tells clients what has changed since the last call.
  void publish();
  [[nodiscard]] bool heard() const { return receiver_->heard(); }
  [[nodiscard]] bool synced() const { return receiver_->heard() && receiver_->synced(); }
  [[nodiscard]] std::int64_t revision() const { return receiver_->revision(); }
  [[nodiscard]] const BrickMap& map() const { return map_; }
  [[nodiscard]] std::uint32_t number() const { return config_.number; }

 private:
  void begin(const std::string& frame_id);
  void take(BrickIndex index, Brick brick);

  NodeContext context_;
  Hub& hub_;
  Config config_;
  BrickMap map_;
  std::int64_t begun_ = 0;
  std::unique_ptr<BrickReceiver> receiver_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

/// What the stack says, as the bridge knows it; tells clients what is new.
class World {
 public:
  World(const NodeContext& context, Hub& hub);
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  [[nodiscard]] const AgentState* agent(const std::string& id) const;
  [[nodiscard]] const std::map<std::string, AgentState>& agents() const { return agents_; }
  struct SeenPose {
    Transform T_map_base;
    std::int64_t utime, heard;
  };
  [[nodiscard]] const SeenPose* pose(const std::string& agent) const;
  [[nodiscard]] const std::map<std::string, SeenPose>& poses() const { return poses_; }
  [[nodiscard]] bool stale(const SeenPose& pose) const { return context_.bus.now() - pose.heard > kStale; }
  /// The path that is kept for a robot; null if there is none, or nobody has said it for a while.
  [[nodiscard]] const concord::Path* active_path(const std::string& robot) const;
  [[nodiscard]] std::vector<const concord::Path*> active_paths() const;
  /// As it was said last, however long ago; null if there is none, or it has ended.
  [[nodiscard]] const concord::Path* last_path(const std::string& robot) const;
  [[nodiscard]] const std::vector<concord::Zone>& zones() const { return zones_.items(); }
  [[nodiscard]] const Things& things() const { return things_; }
  [[nodiscard]] bool alive(const std::string& process) const;
  /// The highest revision of people's corrections that was seen.
  [[nodiscard]] std::int64_t corrections() const { return corrections_; }
  void note_correction(std::int64_t revision) { corrections_ = std::max(corrections_, revision); }

  /// Since when the map stream holds people's corrections, as merge said it last; boot_id 0: it has not yet.
  [[nodiscard]] const MapEdits& map_edits() const { return map_edits_; }

  [[nodiscard]] LayerCopy& map() { return map_; }
  [[nodiscard]] LayerCopy& grid() { return grid_; }
  /// The layer of an agent's submap, heard from now on. Null: there are too many, or no such agent.
  [[nodiscard]] LayerCopy* agent_layer(const std::string& id);

  /// A client is here anew: it is told of people again.
  void welcome(std::int64_t session) { told_people_.erase(session); }

  /// Called with each path that is said, and when agents change.
  std::function<void(const concord::Path&)> on_path;
  std::function<void()> on_agents;

 private:
  static constexpr std::int64_t kStale = 2'000'000;
  static constexpr std::int64_t kSilent = 3'000'000;
  static constexpr std::size_t kMaxAgentLayers = 32;

  void hear();
  void take_agents(const AgentList& list);
  void take_path(const concord::Path& path);
  void tell_processes();
  void tell_poses();
  void tell_people();
  void publish_layers();

  NodeContext context_;
  Hub& hub_;
  LayerCopy map_, conflicts_, grid_;
  LabelCopy labels_;
  Things things_;
  ListReceiver<concord::Zone> zones_;
  ListReceiver<concord::Lease> leases_;
  std::map<std::string, std::unique_ptr<LayerCopy>> agent_layers_;
  std::uint32_t next_stream_ = kFirstAgentStream;
  std::map<std::string, AgentState> agents_;
  std::map<std::string, SeenPose> poses_;
  struct SeenPath {
    concord::Path path;
    std::int64_t heard;
  };
  std::map<std::string, SeenPath> paths_;  ///< active ones, by robot
  std::map<std::string, std::int64_t> processes_;
  std::string told_agents_, told_processes_, told_poses_;
  std::map<std::int64_t, std::string> told_people_;
  std::int64_t corrections_ = 0;
  MapEdits map_edits_;
};

}  // namespace concord::hmd
