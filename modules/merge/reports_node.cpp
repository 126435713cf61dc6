#include "merge/reports_node.hpp"

#include "merge/conflict_report.hpp"

namespace concord {
namespace {

const std::string kHistoryRequests = "in/history_request";
const std::string kConflictRequests = "in/conflict_request";

}  // namespace

ReportsNode::ReportsNode(const NodeContext& context, const People& people, MapStreams& map)
    : context_(context),
      people_(people),
      map_(map),
      replies_(context),
      queue_(context.bus, context.site.stream.bytes_per_second) {
  listen<HistoryRequest>(context_.bus, context_.counters, context_.process, kHistoryRequests,
                         [this](const std::string&, const HistoryRequest& request) { on_history(request); });
  listen<ConflictRequest>(context_.bus, context_.counters, context_.process, kConflictRequests,
                          [this](const std::string&, const ConflictRequest& request) { on_conflicts(request); });
}

void ReportsNode::on_history(const HistoryRequest& request) {
  if (queue_.waits(request.id)) return;
  HistoryPart whole{request.id, 0, 1, people_.history(request)};
  const auto count = static_cast<std::int64_t>(whole.operations.size());
  tell(kHistoryRequests, "out/history", in_parts(std::move(whole)),
       replies_.granted(request.id, people_.revision(), count, "told"));
}

void ReportsNode::on_conflicts(const ConflictRequest& request) {
  if (queue_.waits(request.id)) return;
  map_.refold_and_send();
  ConflictReport report = report_conflicts(map_.layers(), static_cast<std::size_t>(request.most));
  ConflictList whole{request.id, 0, 1, report.regions_in_all, report.voxels_in_all, std::move(report.regions)};
  const auto count = static_cast<std::int64_t>(whole.regions.size());
  tell(kConflictRequests, "out/conflict_list", in_parts(std::move(whole)),
       replies_.granted(request.id, people_.revision(), count, "told"));
}

/// The answer follows the parts, so that who has it and misses a part knows that it was lost.
template <class Part>
void ReportsNode::tell(const std::string& asked_on, const std::string& channel, const std::vector<Part>& parts,
                       const Answer& answer) {
  if (!queue_.has_room(parts.size() + 1)) {
    return replies_.deny(asked_on, answer.id, {Code::kBusy, "earlier reports are still being told; ask again"});
  }
  for (const Part& part : parts) queue_.push(answer.id, channel, encode(part, context_.bus.now()));
  queue_.push(answer.id, kAnswers, encode(answer, context_.bus.now()));
  queue_.send_now();
}

}  // namespace concord
