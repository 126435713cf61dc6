#include "semantic/edit_history_node.hpp"

#include <algorithm>
#include <utility>

namespace concord {
namespace {

constexpr std::int64_t kPeriod = 1'000'000;
constexpr std::size_t kMostOperations = 10'000;  ///< in one answer

}  // namespace

EditHistoryNode::EditHistoryNode(const NodeContext& context, Events events)
    : context_(context), events_(std::move(events)), question_("semantic-" + std::to_string(context.boot_id) + "-") {
  Bus& bus = context_.bus;
  listen<Answer>(bus, context_.counters, context_.process, kAnswers,
                 [this](const std::string&, const Answer& answer) { on_answer(answer); });
  listen<ProcessStatus>(bus, context_.counters, context_.process, "out/status/merge",
                        [this](const std::string&, const ProcessStatus& status) {
                          const auto it = status.counters.find("edit_revision");
                          if (it != status.counters.end()) heard_revision_ = std::max(heard_revision_, it->second);
                        });
  listen<HistoryPart>(bus, context_.counters, context_.process, "out/history",
                      [this](const std::string&, const HistoryPart& part) { on_part(part); });
  bus.every(kPeriod, [this] {
    has_news_ = has_news_ || !open_.empty();  // what was not answered in a second is asked again
    open_.clear();
    ask();
  });
}

/// What merge was asked by anybody may be news to its history. An answer's revision is none of the history's where a
/// map was saved, so only the status says how far that goes.
void EditHistoryNode::on_answer(const Answer& answer) {
  if (answer.process != "merge" || answer.id.starts_with(question_)) return;
  has_news_ = true;
  ask();
}

void EditHistoryNode::ask() {
  if (!open_.empty() || (!has_news_ && heard_revision_ <= known_revision_)) return;
  HistoryRequest request;
  open_ = question_ + std::to_string(++questions_);
  has_news_ = false;
  asked_revision_ = heard_revision_;
  parts_.clear();
  request.id = open_;
  request.after_revision = known_revision_;
  request.most = kMostOperations;
  context_.bus.publish("in/history_request", encode(request, context_.bus.now()));
}

void EditHistoryNode::on_part(const HistoryPart& part) {
  if (part.id != open_) return;
  if (!parts_.empty() && parts_.begin()->second.parts != part.parts) parts_.clear();
  parts_[part.part] = part;
  if (static_cast<std::int32_t>(parts_.size()) < part.parts) return;
  const auto parts = std::exchange(parts_, {});
  open_.clear();
  std::size_t count = 0;
  for (const auto& [number, one] : parts) {
    count += one.operations.size();
    for (const Operation& operation : one.operations) {
      known_revision_ = std::max(known_revision_, operation.revision);
      if (operation.kind == Operation::Kind::kDelete) deletions_[operation.id] = operation;
      events_.on_operation(operation);
    }
  }
  if (count < kMostOperations) {
    known_revision_ = std::max(known_revision_, asked_revision_);
  } else {
    has_news_ = true;
  }
  events_.on_told();
  ask();
}

const Operation* EditHistoryNode::find_deletion(const std::string& id) const {
  const auto it = deletions_.find(id);
  return it != deletions_.end() ? &it->second : nullptr;
}

}  // namespace concord
