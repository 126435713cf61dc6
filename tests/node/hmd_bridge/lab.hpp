#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "access/token_store.hpp"
#include "align/align_node.hpp"
#include "bridge_node.hpp"
#include "bus/lockstep_bus.hpp"
#include "ingest/ingest_node.hpp"
#include "merge/merge_node.hpp"
#include "planner/planner_node.hpp"
#include "semantic/semantic_node.hpp"

namespace concord::hmd {

/// A process's own part of a bus: when it goes, the bus forgets what it was for.
class PartOfBus final : public Bus {
 public:
  explicit PartOfBus(Bus& bus) : bus_(bus) {}
  using Bus::every, Bus::subscribe;
  void subscribe(const std::string& channels, Handler handler, int queued, Owner owner) override {
    bus_.subscribe(channels, std::move(handler), queued, std::move(owner));
  }
  void publish(const std::string& channel, std::span<const std::uint8_t> bytes) override {
    bus_.publish(channel, bytes);
  }
  void every(std::int64_t period, Task task, Owner owner) override {
    bus_.every(period, std::move(task), std::move(owner));
  }
  [[nodiscard]] std::int64_t now() const override { return bus_.now(); }

 private:
  Bus& bus_;
};

/// The whole stack with the bridge on one lockstep bus, and clients that speak to the bridge's hub without sockets.
class Lab {
 public:
  static constexpr std::int64_t kStart = 1'700'000'000'000'000;

  enum With { kAll, kWithoutMerge, kWithoutAlign, kWithoutSemantic, kWithoutIngest };
  explicit Lab(With with = kAll, double resolution = 0.1);
  ~Lab();
  Lab(const Lab&) = delete;
  Lab& operator=(const Lab&) = delete;

  void run(double seconds);
  /// Until `done`, at most so long. @return done().
  bool run_until(double seconds, const std::function<bool()>& done);

  /// robot1 sends a hall 6.4 m by 6.4 m of free space from z = 0 to 0.8 with a floor.
  void robot_maps();
  /// An agent sends a submap, in the frame odom.
  void agent_maps(const std::string& agent, const BrickMap& map);
  /// robot1 says nothing any more.
  void stop_robot() { sent_.erase("robot1"); }
  void restart_bridge();
  void restart_semantic();
  /// Where robot1 is, in its own frame.
  void robot_at(double x, double y);

  Site site;
  MapLimits map_limits;  ///< from the next restart of the bridge on
  Counters counters;
  std::unique_ptr<LockstepBus> bus;
  std::unique_ptr<IngestNode> ingest;
  std::unique_ptr<MergeNode> merge;
  std::unique_ptr<PlannerNode> planner;
  std::unique_ptr<AlignNode> align;
  std::unique_ptr<PartOfBus> semantic_bus;
  std::unique_ptr<SemanticNode> semantic;
  std::unique_ptr<Gate> gate;
  std::unique_ptr<PartOfBus> bridge_bus;
  std::unique_ptr<BridgeNode> bridge;

 private:
  struct Sent {
    BrickMap map;
    std::unique_ptr<BrickSender> sender;
  };
  std::map<std::string, Sent> sent_;  ///< by agent
};

/// A client of the lab's bridge.
class Client {
 public:
  explicit Client(Lab& lab, Peer peer = {"127.0.0.1", true});

  /// Says hello as an agent, or as none. @return the answer or the error.
  Json hello(const std::string& agent = "", const std::string& frame_id = "local1");
  template <class Request>
  Json ask(const Request& request) {
    ++id_;
    return ask_text(id_, request_text(id_, request));
  }
  Json ask_text(std::int64_t id, const std::string& text);
  Json upload(FrameKind kind, std::uint32_t count, std::int64_t sequence, const Bytes& payload);
  template <class Notice>
  void note(const Notice& notice) {
    lab_.bridge->hub().text(connection, notice_text(notice), lab_.bus->now());
    read();
  }
  /// Takes in all that the hub has for this client.
  void read();
  void lose() { lab_.bridge->hub().closed(connection, lab_.bus->now()); }
  [[nodiscard]] std::int64_t last_id() const { return id_; }
  [[nodiscard]] std::int64_t next_id() { return ++id_; }

  Hub::Connection connection = 0;
  std::map<std::int64_t, Json> answers;
  std::map<std::string, Json> events;  ///< the latest body of each
  std::vector<BinaryFrame> frames;
  std::int64_t bytes = 0;

 private:
  Lab& lab_;
  std::int64_t id_ = 0;
};

/// The code of a refusal, "OK" for an answer.
[[nodiscard]] std::string code_of_answer(const Json& answer);

}  // namespace concord::hmd
