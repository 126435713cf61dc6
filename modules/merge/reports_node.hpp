#pragma once

#include <set>
#include <string>

#include "bus/process.hpp"
#include "bus/replies.hpp"
#include "bus/reply_queue.hpp"
#include "merge/map_streams.hpp"
#include "merge/people.hpp"

namespace concord {

/// Tells who changed what, and who claims what where layers conflict: in parts, and then the answer.
class ReportsNode {
 public:
  ReportsNode(const NodeContext& context, const People& people, MapStreams& map);
  ReportsNode(const ReportsNode&) = delete;
  ReportsNode& operator=(const ReportsNode&) = delete;

 private:
  void on_history(const HistoryRequest& request);
  void on_conflicts(const ConflictRequest& request);
  template <class Part>
  void tell(const std::string& asked_on, const std::string& channel, const std::vector<Part>& parts,
            const Answer& answer);

  NodeContext context_;
  const People& people_;
  MapStreams& map_;
  Replies replies_;
  ReplyQueue queue_;
};

}  // namespace concord
