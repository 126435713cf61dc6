#include "align/align_node.hpp"

#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include <spdlog/spdlog.h>

#include "bus/recent_answers.hpp"

namespace concord {
namespace {

constexpr std::int64_t kLookPeriod = 20'000;  // microseconds
constexpr std::int64_t kRepeatPeriod = 1'000'000;
const std::string kRequests = "in/align";
const std::string kDecisions = "in/align_decision";
const std::string kResults = "out/align";

int all_threads() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

/// Of all that it asks, its time left out: that is only when it was asked.
std::uint64_t content_without_time(AlignRequest request) {
  request.utime = 0;
  return content_of(encode(request));
}

std::string centimetres(double metres) { return std::to_string(std::lround(100.0 * metres)) + " cm"; }

/// What people are told of an agent that slipped.
std::string words_of_slip(const AlignResult& result) {
  return result.source.agent + " has slipped by " + centimetres(result.slip) + " and " +
         std::to_string(std::lround(10.0 * result.slip_angle * 180.0 / M_PI) / 10.0).substr(0, 4) +
         " degrees against the others; accept " + result.id + " to put it right";
}

}  // namespace

AlignNode::AlignNode(const NodeContext& context, std::launch how)
    : context_(context),
      how_(how),
      site_{context.site.resolution, context.site.merge.policy},
      replies_(context),
      layers_(context) {
  listen<AlignRequest>(context_.bus, context_.counters, context_.process, kRequests,
                       [this](const std::string&, AlignRequest request) { on_request(std::move(request)); });
  listen<AlignDecision>(context_.bus, context_.counters, context_.process, kDecisions,
                        [this](const std::string&, const AlignDecision& decision) { on_decision(decision); });
  context_.bus.every(kLookPeriod, [this] { go_on(); });
  context_.bus.every(kRepeatPeriod, [this] {
    for (const AlignResult* result : desk_.standing(context_.bus.now())) say(*result);
    count();
  });
}

void AlignNode::on_request(AlignRequest request) {
  const std::uint64_t content = content_without_time(request);
  const auto known = desk_.find(request.id, content);
  if (!known) return replies_.deny(kRequests, request.id, known.error());
  if (*known != nullptr) return tell(**known);
  if (const auto can = check_task(request, layers_.now()); !can) {
    const bool is_early = !layers_.settled() && can.error().code != Code::kBadRequest;
    const Error early{Code::kBusy, "align has just begun and has not heard everybody yet; ask again"};
    return replies_.deny(kRequests, request.id, is_early ? early : can.error());
  }
  const std::string id = request.id;
  if (const auto taken = desk_.take(std::move(request), content); !taken) {
    return replies_.deny(kRequests, id, taken.error());
  }
  tell(**desk_.find(id, content));
}

/// Once more how it stands: what was said may have been lost.
void AlignNode::tell(const AlignDesk::Case& one) {
  const std::string& id = one.request.id;
  if (one.state != AlignDesk::Case::State::kDone) {
    const std::size_t ahead = desk_.ahead_of(id);
    const std::string how = ahead == 0 ? "it is being looked at" : std::to_string(ahead) + " are before it";
    return answer(context_.bus, {id, context_.process, false, name(Code::kBusy), how + "; ask again", 0, 0});
  }
  say(one.result);
  const Alignment& evidence = one.result.evidence;
  const auto overlap = static_cast<std::int64_t>(std::lround(100.0 * evidence.overlap()));
  answer(context_.bus, {id, context_.process, evidence.accepted(), evidence.accepted() ? "OK" : name(evidence.reason),
                        evidence.message, one.result.source.revision, overlap});
}

void AlignNode::say(const AlignResult& result) { context_.bus.publish(kResults, encode(result)); }

void AlignNode::on_decision(const AlignDecision& decision) {
  if (decision.op == AlignDecision::Op::kDrop) {
    const auto dropped = desk_.drop(decision);
    if (!dropped) return replies_.deny(kDecisions, decision.id, dropped.error());
    return replies_.grant(decision.id, 0, 1, decision.align_id + " is dropped");
  }
  const auto accepted = desk_.accept(decision, layers_.now(), context_.bus.now());
  if (!accepted) return replies_.deny(kDecisions, decision.id, accepted.error());
  // Merge answers by the decision's own id, to who decided; asked again it answers again.
  context_.bus.publish("in/transform", encode(accepted->request, context_.bus.now()));
  if (accepted->is_founding) {
    answer(context_.bus, {decision.id, context_.process, false, name(Code::kBusy),
                          accepted->request.agent + " founds the map first; ask again in a second", 0, 0});
  }
}

void AlignNode::go_on() {
  if (running_) {
    if (running_->found.wait_for(std::chrono::seconds(0)) == std::future_status::timeout) return;
    Running done = *std::exchange(running_, std::nullopt);
    const Found found = done.found.get();
    done.task->is_recheck ? finish_watch(*done.task, found) : finish(*done.task, found);
  }
  begin();
  if (!running_) begin_watch();
}

void AlignNode::begin() {
  while (const AlignRequest* request = desk_.begin_next()) {
    auto task = make_task(*request, layers_.now(), site_);
    if (task) return start(std::move(*task));
    // It could be done when it was asked.
    const std::string id = request->id;
    desk_.give_up(id);
    replies_.deny(kRequests, id, task.error());
  }
}

void AlignNode::begin_watch() {
  const std::int64_t now = context_.bus.now();
  const auto agent = watch_.next(layers_.now(), now);
  if (!agent) return;
  auto task = make_recheck(*agent, layers_.now(), site_);
  if (task) {
    task->id = "slip-" + *agent + "-" + std::to_string(now);
    return start(std::move(*task));
  }
  watch_.looked_at(*agent, layers_.now(), 0, now);
  desk_.withdraw_offer(*agent);
}

/// A request may have all processors; the watch has one.
void AlignNode::start(AlignTask task) {
  auto shared = std::make_shared<const AlignTask>(std::move(task));
  const int threads = shared->is_recheck ? 1 : all_threads();
  running_ = {shared, std::async(how_, [shared, threads] {
                const auto begun = std::chrono::steady_clock::now();
                auto alignment = carry_out(*shared, threads);
                const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begun;
                if (alignment) alignment->ms = 1e-3 * took.count();
                return Found{std::move(alignment), std::llround(took.count())};
              })};
}

void AlignNode::finish(const AlignTask& task, const Found& found) {
  if (!found.alignment) {
    desk_.give_up(task.id);
    return replies_.deny(kRequests, task.id, found.alignment.error());
  }
  const AlignResult* result = desk_.finish(task, result_of(task, *found.alignment, context_.bus.now()));
  context_.counters.add(std::string("requests.") + name(found.alignment->reason));
  if (result == nullptr) return;  // dropped meanwhile
  say(*result);
  count();
}

void AlignNode::finish_watch(const AlignTask& task, const Found& found) {
  const std::int64_t now = context_.bus.now();
  const std::string& agent = task.used_source.agent;
  watch_.looked_at(agent, layers_.now(), found.took, now);
  context_.counters.add("looks");
  if (!found.alignment) return context_.counters.refused("watch", found.alignment.error());
  AlignResult result = result_of(task, *found.alignment, now);
  const Slip slip = slip_between(*task.T_target_source, result.evidence.T_target_source, task.p_source_middle);
  if (!result.evidence.accepted()) {
    // Too little in common says nothing; but what the others contradict people should know.
    if (!contradicts(*found.alignment)) return desk_.withdraw_offer(agent);
    result.evidence.message = agent + " and the others contradict each other, and no place is found where they do not";
  } else if (slip.is_large(site_.resolution)) {
    result.slip = slip.metres;
    result.slip_angle = slip.radians;
    result.evidence.message = words_of_slip(result);
  } else {
    return desk_.withdraw_offer(agent);
  }
  if (!desk_.has_offer(agent)) spdlog::warn("{}", result.evidence.message);
  say(desk_.offer(task, std::move(result)));
  count();
}

void AlignNode::count() {
  context_.counters.set("waiting", static_cast<std::int64_t>(desk_.waiting()));
  context_.counters.set("slipped", static_cast<std::int64_t>(desk_.offers()));
  context_.counters.set("submaps", static_cast<std::int64_t>(layers_.now().size()));
}

}  // namespace concord
