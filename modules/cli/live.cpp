#include "cli/live.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "cli/end_request.hpp"

namespace concord {

Live::Live(const Common& common)
    : site_(common.site()),
      timeout_(common.timeout),
      bus_(site_.lcm_url, counters_),
      id_prefix_("cli-" + std::to_string(getpid()) + "-" + std::to_string(bus_.now()) + "-") {
  // Only what is ours is kept: others' answers are many.
  hear<Answer>(kAnswers, [this](const std::string&, Answer answer) {
    if (is_ours(answer.id)) answers_[answer.id][answer.process] = std::move(answer);
  });
  hear<Path>("out/path/.*", [this](const std::string&, Path path) {
    if (is_ours(path.id)) paths_[path.id] = std::move(path);
  });
  hear<AgentList>("out/agents", [this](const std::string&, const AgentList& list) { resolution_ = list.resolution; });
}

tl::expected<void, Failure> Live::take_resolution() {
  if (!wait(timeout_, [this] { return resolution_.has_value(); })) return no_answer("merge");
  site_.resolution = *resolution_;
  return {};
}

std::string Live::new_id() { return id_prefix_ + std::to_string(++next_id_); }

std::string Live::id_or_new(const std::string& given) {
  if (given.empty()) return new_id();
  given_.insert(given);
  return given;
}

bool Live::wait(double seconds, const std::function<bool()>& done) {
  const std::int64_t end = bus_.now() + std::llround(seconds * 1e6);
  while (!done() && bus_.now() < end && !end_requested()) bus_.spin_once(10);
  return done();
}

bool Live::wait_while_moving(double seconds, const std::function<std::int64_t()>& moves,
                             const std::function<bool()>& done) {
  std::int64_t seen = moves(), since = bus_.now();
  while (!done() && bus_.now() - since < std::llround(seconds * 1e6) && !end_requested()) {
    bus_.spin_once(10);
    if (moves() == seen) continue;
    seen = moves();
    since = bus_.now();
  }
  return done();
}

bool Live::ask_until(const std::string& channel, const Bytes& request, double seconds,
                     const std::function<bool()>& done) {
  std::int64_t due = bus_.now();
  return wait(seconds, [&] {
    if (done()) return true;
    if (bus_.now() >= due) {
      bus_.publish(channel, request);
      due = bus_.now() + kAskAgain;
    }
    return false;
  });
}

const Answer* Live::answer_to(const std::string& id) const {
  const auto it = answers_.find(id);
  return it != answers_.end() ? &it->second.begin()->second : nullptr;
}

const Answer* Live::answer_to(const std::string& id, const std::string& process) const {
  const auto by_process = answers_.find(id);
  if (by_process == answers_.end()) return nullptr;
  const auto it = by_process->second.find(process);
  return it != by_process->second.end() ? &it->second : nullptr;
}

const Path* Live::path_for(const std::string& id) const {
  const auto it = paths_.find(id);
  return it != paths_.end() ? &it->second : nullptr;
}

tl::unexpected<Failure> Live::no_answer(const std::string& who) const {
  return fail(Exit::kNoAnswer, "NO_ANSWER",
              who + " did not answer in time; is the stack running on " + site_.lcm_url + "? (concord status)");
}

bool is_busy(const Answer& answer) { return !answer.ok && answer.code == name(Code::kBusy); }

tl::unexpected<Failure> refused(const Answer& answer) {
  return fail(Exit::kRefused, answer.code, answer.process + ": " + answer.message);
}

tl::expected<Answer, Failure> Live::ask_bytes(const std::string& channel, const Bytes& request, const std::string& id) {
  answers_.erase(id);  // a lease is asked for with one id again and again
  ask_until(channel, request, timeout_, [&] { return answer_to(id) != nullptr && !is_busy(*answer_to(id)); });
  if (answer_to(id) == nullptr) {
    auto failure = no_answer("the stack");
    failure.value().message += "; it may be done all the same: asked again with --id " + id + " it is done once";
    return failure;
  }
  const Answer& answer = *answer_to(id);
  if (!answer.ok) return refused(answer);
  return answer;
}

StreamCopy::Copied::Copied(Live& live, const std::string& stream)
    : receiver(live.bus(), live.counters(), {.stream = stream, .resolution = live.site().resolution},
               {.on_frame = [this](const std::string&) { map.clear(); },
                .on_brick = [this](BrickIndex index, Brick brick) { map.set(index, std::move(brick)); },
                .on_end = [this] { map.clear(); }}) {}

StreamCopy::StreamCopy(Live& live, const std::string& stream)
    : stream_(stream), copied_(std::make_shared<Copied>(live, stream)) {
  const StreamChannels channels(stream);
  live.hear<BrickPacket>(channels.bricks, [copied = copied_](const std::string&, const BrickPacket& packet) {
    copied->receiver.on_packet(packet);
  });
  live.hear<BrickDigest>(channels.digest, [copied = copied_](const std::string&, const BrickDigest& digest) {
    copied->receiver.on_digest(digest);
  });
}

tl::expected<void, Failure> StreamCopy::wait_synced(Live& live, const std::function<bool()>& worth_it) {
  live.wait(live.timeout(), [&] { return synced() || !worth_it(); });
  if (synced()) return {};
  if (!heard()) return live.no_answer("the sender of " + stream_);
  return fail(Exit::kIncomplete, "INCOMPLETE",
              stream_ + " has not arrived whole: " + std::to_string(missing()) +
                  " versions are missing; give a longer --timeout");
}

tl::expected<void, Failure> wait_for_submap(Live& live, StreamCopy& copy, const std::string& agent) {
  // Lists and idle streams both speak once a second: after some of one, nothing of the other means that it is not
  // there.
  constexpr int kLists = 3;
  struct Heard {
    int lists = 0;
    std::optional<AgentState> state;
  };
  const auto heard = std::make_shared<Heard>();  // the subscription outlives this call
  live.hear<AgentList>("out/agents", [heard, agent](const std::string&, const AgentList& list) {
    const auto found = std::ranges::find(list.agents, agent, &AgentState::id);
    heard->state = found != list.agents.end() ? std::optional(*found) : std::nullopt;
    ++heard->lists;
  });
  const auto hopeless = [&] {
    if (copy.heard() || heard->lists < kLists) return false;
    return !heard->state || (heard->state->known == 0 && heard->state->revision == 0);
  };
  const auto synced = copy.wait_synced(live, [&] { return !hopeless(); });
  if (copy.ended() || (hopeless() && !heard->state)) {
    return fail(Exit::kRefused, name(Code::kNoAgent), "no agent " + agent + " is known; see: concord agents");
  }
  if (hopeless()) return fail(Exit::kRefused, name(Code::kNoMap), agent + " has sent no submap");
  return synced;
}

tl::expected<Path, Failure> request_path(Live& live, const PathRequest& request) {
  const auto done = [&] { return live.path_for(request.id) != nullptr || live.answer_to(request.id) != nullptr; };
  const auto bytes = to_send(request, live.bus().now());
  if (!bytes) return tl::unexpected(bytes.error());
  if (!live.ask_until("in/path_request", *bytes, live.timeout(), done)) {
    return live.no_answer("the planner");
  }
  if (const Path* path = live.path_for(request.id)) return *path;
  return refused(*live.answer_to(request.id));
}

}  // namespace concord
