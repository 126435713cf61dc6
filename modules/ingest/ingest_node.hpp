#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "bus/brick_stream.hpp"
#include "bus/messages.hpp"
#include "bus/process.hpp"
#include "bus/recent_answers.hpp"
#include "bus/reply_queue.hpp"
#include "ingest/agent_streams.hpp"
#include "ingest/ingest.hpp"
#include "ingest/layer_store.hpp"

namespace concord {

/// Ingest on the bus: hears `in/AGENT/{bricks,digest,octomap,cloud}` and requests, keeps every layer on disk, and says
/// each as the stream `out/agent/AGENT`. A request is on disk before it is answered.
class IngestNode {
 public:
  /// The bus must not be used after the node has gone.
  /// @throws std::runtime_error if the layers on disk cannot be used.
  explicit IngestNode(const NodeContext& context);
  IngestNode(const IngestNode&) = delete;
  IngestNode& operator=(const IngestNode&) = delete;
  /// Writes what is not on disk yet.
  ~IngestNode();

 private:
  /// What comes in from one agent as a brick stream.
  struct Input {
    std::unique_ptr<BrickReceiver> receiver;
    std::int64_t last_heard = 0;
    bool lacking = false;  ///< bricks were refused because the layer was full
  };

  void restore();
  void subscribe();

  void on_packet(const std::string& channel, const BrickPacket& packet);
  void on_digest(const std::string& channel, const BrickDigest& digest);
  void on_octomap(const std::string& channel, const OctomapMessage& message);
  void on_cloud(const std::string& channel, const CloudMessage& message);

  [[nodiscard]] Result<void> admit(const std::string& id, const std::string& frame_id, Source source) const;
  [[nodiscard]] bool admitted(const std::string& channel, const std::string& frame_id, Source source);
  void say_frame_over(const std::string& id, const std::string& frame_id);
  [[nodiscard]] BrickReceiver* receiver_of(const std::string& channel, const std::string& frame_id);
  [[nodiscard]] std::unique_ptr<BrickReceiver> make_receiver(const std::string& id);
  void ask_again_where_there_is_room();
  void forget_silent_strangers();
  void changed(const std::string& id, const Change& change);

  void on_agent_request(const std::string& channel, const AgentRequest& request);
  void on_map_request(const std::string& channel, const MapRequest& request);
  void await_merge(const MapRequest& request);
  void on_answer(const std::string& channel, const Answer& word);
  void on_downsample(const std::string& channel, const DownsampleRequest& request);
  [[nodiscard]] Result<std::int64_t> reset(const std::string& id);
  [[nodiscard]] Result<std::int64_t> remove(const std::string& id);
  [[nodiscard]] Result<std::int64_t> load_octomap(const MapRequest& request, const std::filesystem::path& file);
  [[nodiscard]] Result<std::int64_t> load_archive(const MapRequest& request, std::int64_t incarnation);
  [[nodiscard]] Result<std::int64_t> downsample(const DownsampleRequest& request);
  [[nodiscard]] Answer answer_to(const std::string& id, const Result<std::int64_t>& count, const std::string& done);

  void write_some();
  void wrote(const Result<void>& done);
  void count();

  Bus& bus_;
  Counters& counters_;
  const Site& site_;
  std::string process_;
  Ingest ingest_;
  LayerStore store_;
  AgentStreams streams_;
  ReplyQueue replies_;
  RecentAnswers answers_;
  std::deque<MapRequest> awaiting_;  ///< to load a native map; the oldest first
  std::map<std::string, Input> inputs_;
  std::map<std::string, std::int64_t> said_over_;  ///< when an agent was last told that its frame is over
  std::int64_t write_at_ = 0;                      ///< not before this time
};

}  // namespace concord
