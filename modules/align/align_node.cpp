#include "align/align_node.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
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
const std::string kMerge = "merge";

int all_threads() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

/// Of all that it asks, its time left out: that is only when it was asked.
std::uint64_t content_without_time(AlignRequest request) {
  request.utime = 0;
  return content_of(encode(request));
}

std::string centimetres(double metres) { return std::to_string(std::lround(100.0 * metres)) + " cm"; }

/// What computing throws is an answer like any other, or whoever asked would wait for ever: mostly there is not enough
/// memory.
template <class Make>
auto guarded(const Make& make) -> decltype(make()) {
  try {
    return make();
  } catch (const std::bad_alloc&) {
    return refuse(Code::kTooLarge, "there is not enough memory to align these; align coarser copies of the maps");
  } catch (const std::exception& e) {
    return refuse(Code::kBadRequest, std::string("alignment failed: ") + e.what());
  }
}

/// What people are told of an agent that slipped.
std::string words_of_slip(const AlignResult& result) {
  return result.source.agent + " has slipped by " + centimetres(result.slip) + " and " +
         std::to_string(std::lround(10.0 * result.slip_angle * 180.0 / M_PI) / 10.0).substr(0, 4) +
         " degrees against the others; accept " + result.id + " to put it right";
}

/// And of one that lies wrong, nobody knows how.
std::string words_of_contradiction(const AlignResult& result) {
  return result.source.agent + " and the others contradict each other where it lies, in " +
         std::to_string(std::lround(100.0 * result.evidence.against_upright)) +
         " % of the walls: it has slipped, or something large was moved; align it again, or map the place anew";
}

}  // namespace

AlignNode::AlignNode(const NodeContext& context, std::launch how, Compute compute)
    : context_(context),
      how_(how),
      compute_(std::move(compute)),
      site_{context.site.resolution, context.site.merge.policy},
      replies_(context),
      layers_(context),
      founding_(context_, desk_, layers_) {
  listen<AlignRequest>(context_.bus, context_.counters, context_.process, kRequests,
                       [this](const std::string&, AlignRequest request) { on_request(std::move(request)); });
  listen<AlignDecision>(context_.bus, context_.counters, context_.process, kDecisions,
                        [this](const std::string&, const AlignDecision& decision) { on_decision(decision); });
  listen<Answer>(context_.bus, context_.counters, context_.process, kAnswers,
                 [this](const std::string&, const Answer& answer) {
                   if (answer.process != kMerge || answer.code == name(Code::kBusy)) return;
                   desk_.on_merge(answer.id, answer.ok);
                 });
  context_.bus.every(kLookPeriod, [this] { go_on(); });
  context_.bus.every(kRepeatPeriod, [this] { repeat(); });
}

AlignNode::~AlignNode() {
  if (running_) running_->stop.request_stop();
}

void AlignNode::repeat() {
  const std::int64_t now = context_.bus.now();
  const AgentLayers& layers = layers_.now();
  desk_.heed(layers);
  founding_.go_on();
  for (const std::string& agent : desk_.expire_offers(now)) watch_.forget(agent);
  for (const AlignResult* result : desk_.standing(layers, now)) say(*result);
  count();
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
  if (running_ && running_->look) running_->stop.request_stop();  // people do not wait for the watch
  tell(**desk_.find(id, content));
}

/// Once more how it stands: what was said may have been lost.
void AlignNode::tell(const AlignDesk::Case& one) {
  const std::string& id = one.request.id;
  if (one.state == AlignDesk::Case::State::kDropped) {
    return replies_.deny(kRequests, id, {Code::kExpired, "it was dropped; ask with a new id"});
  }
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
    if (running_ && running_->task->id == decision.align_id) running_->stop.request_stop();
    return replies_.grant(decision.id, 0, 1, decision.align_id + " is dropped");
  }
  const auto is_founded = layers_.map_is_founded();
  if (!is_founded) {
    const Error unknown{Code::kBusy, "merge has not said yet who is in the map; ask again in a second"};
    return replies_.deny(kDecisions, decision.id, unknown);
  }
  const auto accepted = desk_.accept(decision, layers_.now(), *is_founded, context_.bus.now());
  if (!accepted) return replies_.deny(kDecisions, decision.id, accepted.error());
  // What is not written down could stay half done.
  if (const auto kept = founding_.keep(); !kept) return replies_.deny(kDecisions, decision.id, kept.error());
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
    end(*done.task, std::move(done.look), done.found.get());
  }
  begin();
  if (!running_) begin_watch();
}

void AlignNode::begin() {
  while (!running_) {
    const AlignRequest* request = desk_.begin_next();
    if (request == nullptr) return;
    auto task = guarded([&] { return make_task(*request, layers_.now(), site_); });
    if (task) {
      start(std::move(*task), std::nullopt);
      continue;
    }
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
  DriftWatch::Look look = DriftWatch::begin(*agent, layers_.now());
  auto task = guarded([&] { return make_recheck(*agent, layers_.now(), site_); });
  if (!task) return watch_.looked_at(std::move(look), 0, now);
  task->id = "slip-" + *agent + "-" + std::to_string(now);
  start(std::move(*task), std::move(look));
}

/// A request may have all processors; the watch has one.
void AlignNode::start(AlignTask task, std::optional<DriftWatch::Look> look) {
  auto shared = std::make_shared<const AlignTask>(std::move(task));
  const int threads = shared->is_recheck ? 1 : all_threads();
  std::stop_source stop;
  auto begun = guarded([&]() -> Result<std::future<Found>> {
    return std::async(how_, [shared, threads, token = stop.get_token(), compute = compute_] {
      const auto start = std::chrono::steady_clock::now();
      auto alignment = guarded([&] { return compute(*shared, threads, token); });
      const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
      if (alignment) alignment->ms = 1e-3 * took.count();
      return Found{std::move(alignment), std::llround(took.count())};
    });
  });
  if (!begun) return end(*shared, std::move(look), {tl::unexpected(begun.error()), 0});
  running_ = Running{std::move(shared), std::move(look), std::move(stop), std::move(*begun)};
}

void AlignNode::end(const AlignTask& task, std::optional<DriftWatch::Look> look, const Found& found) {
  if (!look) return finish(task, found);
  // Stopped for a person: it is looked at another time.
  if (!found.alignment && found.alignment.error().code == Code::kExpired) return;
  watch_.looked_at(std::move(*look), found.took, context_.bus.now());
  finish_watch(task, found);
}

void AlignNode::finish(const AlignTask& task, const Found& found) {
  if (!found.alignment) {
    if (desk_.give_up(task.id)) replies_.deny(kRequests, task.id, found.alignment.error());
    return;
  }
  const AlignResult* result = desk_.finish(task, result_of(task, *found.alignment, context_.bus.now()));
  if (result == nullptr) return;  // dropped meanwhile
  context_.counters.add(std::string("requests.") + name(found.alignment->reason));
  say(*result);
  count();
}

void AlignNode::finish_watch(const AlignTask& task, const Found& found) {
  const std::string& agent = task.used_source.agent;
  context_.counters.add("looks");
  if (!found.alignment) return context_.counters.refused("watch", found.alignment.error());
  // Somebody moved it meanwhile, or the others: then it says nothing of how they lie now, and they are looked at again.
  const auto stands = [&](const Place& place) { return lies_at(place, layers_.now()); };
  if (!std::ranges::all_of(places_of(task), stands)) return;
  AlignResult result = result_of(task, *found.alignment, context_.bus.now());
  const Slip slip = slip_between(*task.T_target_source, result.evidence.T_target_source, task.p_source_middle);
  if (contradicts(*found.alignment)) {
    result.evidence.message = words_of_contradiction(result);
  } else if (!result.evidence.accepted()) {
    return;  // too little to say anything, nor that what was said no longer holds
  } else if (slip.is_large(site_.resolution)) {
    result.slip = slip.metres;
    result.slip_angle = slip.radians;
    result.evidence.message = words_of_slip(result);
  } else {
    return desk_.withdraw_offer(agent);
  }
  const bool is_news = !desk_.has_offer(agent);
  if (const AlignResult* offered = desk_.offer(task, std::move(result))) {
    if (is_news) spdlog::warn("{}", offered->evidence.message);
    say(*offered);
  }
  count();
}

void AlignNode::count() {
  context_.counters.set("waiting", static_cast<std::int64_t>(desk_.waiting()));
  context_.counters.set("slipped", static_cast<std::int64_t>(desk_.offers()));
  context_.counters.set("submaps", static_cast<std::int64_t>(layers_.now().size()));
}

}  // namespace concord
