#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "align/align_desk.hpp"
#include "align/drift_watch.hpp"
#include "align/founding_node.hpp"
#include "bus/layers_node.hpp"
#include "bus/process.hpp"
#include "bus/replies.hpp"

namespace concord {

/// Alignment on the bus: hears requests and decisions, says what was found on `out/align`, and watches over those who
/// are aligned. It moves nobody: what people accept it asks merge for, in their name.
class AlignNode {
 public:
  /// As carry_out.
  using Compute = std::function<Result<Alignment>(const AlignTask&, int threads, std::stop_token)>;

  /// `how` alignments are computed: beside the bus (async), or within it (deferred), where time stands still.
  AlignNode(const NodeContext& context, std::launch how, Compute compute = carry_out);
  /// Ends what is being computed.
  ~AlignNode();
  AlignNode(const AlignNode&) = delete;
  AlignNode& operator=(const AlignNode&) = delete;

 private:
  struct Found {
    Result<Alignment> alignment;
    std::int64_t took = 0;  ///< microseconds
  };
  struct Running {
    std::shared_ptr<const AlignTask> task;
    std::optional<DriftWatch::Look> look;  ///< of the watch
    std::stop_source stop;
    std::future<Found> found;
  };

  void on_request(AlignRequest request);
  void on_decision(const AlignDecision& decision);
  void tell(const AlignDesk::Case& one);
  void say(const AlignResult& result);

  void go_on();
  void begin();
  void begin_watch();
  void start(AlignTask task, std::optional<DriftWatch::Look> look);
  void end(const AlignTask& task, std::optional<DriftWatch::Look> look, const Found& found);
  void finish(const AlignTask& task, const Found& found);
  void finish_watch(const AlignTask& task, const Found& found);
  void repeat();
  void count();

  NodeContext context_;
  std::launch how_;
  Compute compute_;
  AlignSite site_;
  Replies replies_;
  LayersNode layers_;
  AlignDesk desk_;
  FoundingNode founding_;
  DriftWatch watch_;
  std::optional<Running> running_;
};

}  // namespace concord
