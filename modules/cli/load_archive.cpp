#include "cli/load_archive.hpp"

#include <memory>

#include <nlohmann/json.hpp>

#include "cli/report.hpp"

namespace concord {
namespace {

/// Each time merge looks whether the layers have arrived.
constexpr std::int64_t kAskToLoadAgain = 1'000'000;

bool is_refusal(const Answer* answer) { return answer != nullptr && !answer->ok && !is_busy(*answer); }
bool is_done(const Answer* answer) { return answer != nullptr && answer->ok; }

/// What merge holds of all agents: grows while layers arrive.
std::shared_ptr<std::int64_t> watch_layers(Live& live) {
  auto held = std::make_shared<std::int64_t>(0);
  live.hear<AgentList>("out/agents", [held](const std::string&, const AgentList& list) {
    *held = 0;
    for (const AgentState& agent : list.agents) *held += agent.known + agent.revision;
  });
  return held;
}

/// Whether semantic runs, so that its answer is waited for.
std::shared_ptr<bool> hears_semantic(Live& live) {
  auto heard = std::make_shared<bool>(false);
  live.hear<ProcessStatus>("out/status/semantic", [heard](const std::string&, const ProcessStatus&) { *heard = true; });
  return heard;
}

tl::unexpected<Failure> not_loaded(Live& live, const MapRequest& request) {
  const Answer* ingest = live.answer_to(request.id, "ingest");
  const Answer* merge = live.answer_to(request.id, "merge");
  if (ingest == nullptr && merge == nullptr) return live.no_answer("the stack");
  if (ingest == nullptr) return live.no_answer("ingest");
  if (merge == nullptr) return live.no_answer("merge");
  const Answer* semantic = live.answer_to(request.id, "semantic");
  if (merge->ok && semantic == nullptr) return live.no_answer("semantic");
  const Answer& last = merge->ok && !semantic->ok ? *semantic : *merge;
  return fail(Exit::kIncomplete, name(Code::kBusy),
              last.process + ": " + last.message + "; ask again with --id " + request.id + " and a longer --timeout");
}

/// Somebody took a name of the file's between ingest's taking its layers and merge's taking what people made: the
/// layers are there, and the rest comes once the name is free.
tl::unexpected<Failure> refused_half_way(const Answer& answer, bool has_layers) {
  auto failure = refused(answer);
  if (has_layers) {
    failure.value().message += "; its layers are loaded. Put that right, then ask again with --id " + answer.id +
                               ": what people made is then added";
  }
  return failure;
}

}  // namespace

Outcome load_archive(Live& live, const MapRequest& request, const Common& common) {
  if (!request.agent.empty()) {
    return fail(Exit::kUnusable, "BAD_REQUEST",
                "the layers of a .concord file keep their ids: --agent does not go with it");
  }
  const auto ingest = [&] { return live.answer_to(request.id, "ingest"); };
  const auto merge = [&] { return live.answer_to(request.id, "merge"); };
  const auto semantic = [&] { return live.answer_to(request.id, "semantic"); };
  const auto labels_done = [runs = hears_semantic(live), semantic] {
    return semantic() != nullptr ? is_done(semantic()) : !*runs;
  };
  const auto message = to_send(request, live.bus().now());
  if (!message) return tl::unexpected(message.error());
  const auto held = watch_layers(live);
  std::int64_t due = 0;
  live.wait_while_moving(
      live.timeout(), [&] { return *held; },
      [&] {
        if (is_refusal(ingest()) || is_refusal(merge()) || is_refusal(semantic())) return true;
        if (is_done(ingest()) && is_done(merge()) && labels_done()) return true;
        if (live.bus().now() >= due) {
          live.bus().publish("in/map_request", *message);
          due = live.bus().now() + kAskToLoadAgain;
        }
        return false;
      });
  if (is_refusal(ingest())) return refused(*ingest());
  if (is_refusal(merge())) return refused_half_way(*merge(), is_done(ingest()));
  if (is_refusal(semantic())) return refused_half_way(*semantic(), is_done(ingest()));
  if (!is_done(ingest()) || !is_done(merge()) || !labels_done()) return not_loaded(live, request);
  nlohmann::json object = {{"id", request.id}, {"ingest", to_json(*ingest())}, {"merge", to_json(*merge())}};
  std::string words = "ingest: " + ingest()->message + "\nmerge: " + merge()->message;
  if (semantic() != nullptr) {
    object["semantic"] = to_json(*semantic());
    words += "\nsemantic: " + semantic()->message;
  }
  common.print(object, words);
  return Exit::kDone;
}

}  // namespace concord
