#include "cli/align_live.hpp"

#include <map>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include <nlohmann/json.hpp>

#include "align/prepare.hpp"
#include "cli/align_page.hpp"
#include "cli/align_report.hpp"
#include "cli/live.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "cli/table.hpp"
#include "core/text.hpp"

namespace concord {
namespace {

const std::string kResults = "out/align";
constexpr double kListen = 1.5;  // seconds: what stands is said each second

/// A request on its way.
struct Asked {
  std::optional<AlignResult> result;
  std::optional<Answer> refusal;  ///< it cannot be done
  std::int64_t answers = 0;       ///< whoever is told to wait knows that somebody is there
};

/// What was found has a revision; what cannot be done has none.
bool is_refusal(const Answer& answer) { return !answer.ok && !is_busy(answer) && answer.revision == 0; }

tl::expected<AlignResult, Failure> request_alignment(Live& live, const AlignRequest& request) {
  const auto asked = std::make_shared<Asked>();  // the subscriptions outlive this call
  live.hear<AlignResult>(kResults, [asked, id = request.id](const std::string&, AlignResult result) {
    if (result.id == id) asked->result = std::move(result);
  });
  live.hear<Answer>(kAnswers, [asked, id = request.id](const std::string&, Answer answer) {
    if (answer.id != id) return;
    ++asked->answers;
    if (is_refusal(answer)) asked->refusal = std::move(answer);
  });
  std::int64_t due = 0;
  live.wait_while_moving(
      live.timeout(), [&] { return asked->answers; },
      [&] {
        if (asked->result || asked->refusal) return true;
        if (live.bus().now() >= due) {
          live.bus().publish("in/align", encode(request));
          due = live.bus().now() + kAskAgain;
        }
        return false;
      });
  if (asked->result) return std::move(*asked->result);
  if (asked->refusal) return refused(*asked->refusal);
  return live.no_answer("align");
}

/// Merge's word where the agent is placed; align's where it is not.
tl::expected<Answer, Failure> decide(Live& live, const AlignDecision& decision) {
  const auto last_word = [&]() -> const Answer* {
    const Answer* merge = live.answer_to(decision.id, "merge");
    if (merge != nullptr && !is_busy(*merge)) return merge;
    const Answer* align = live.answer_to(decision.id, "align");
    return align != nullptr && !is_busy(*align) ? align : nullptr;
  };
  live.ask_until("in/align_decision", encode(decision), live.timeout(), [&] { return last_word() != nullptr; });
  const Answer* answer = last_word();
  if (answer == nullptr) return live.no_answer("align or merge");
  if (!answer->ok) return refused(*answer);
  return *answer;
}

int all_threads() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

/// Both as they lie before anything is accepted; the map has the source in it too if it is aligned.
struct Copies {
  BrickMap target, source;
};

tl::expected<BrickMap, Failure> copy_of(Live& live, const std::string& stream, const std::string& agent) {
  StreamCopy copy(live, stream);
  const auto synced = agent.empty() ? copy.wait_synced(live) : wait_for_submap(live, copy, agent);
  if (!synced) return tl::unexpected(synced.error());
  return copy.map();
}

tl::expected<Copies, Failure> copy_both(const AlignLive& wanted, const Common& common) {
  Live live(common);
  auto source = copy_of(live, "out/agent/" + wanted.source, wanted.source);
  if (!source) return tl::unexpected(source.error());
  const std::string stream = wanted.target.empty() ? "out/map" : "out/agent/" + wanted.target;
  auto target = copy_of(live, stream, wanted.target);
  if (!target) return tl::unexpected(target.error());
  return Copies{std::move(*target), std::move(*source)};
}

tl::expected<void, Failure> draw(const AlignLive& wanted, const Copies& copies, double resolution,
                                 const AlignResult& result) {
  const auto source = prepare_map(copies.source, resolution, all_threads());
  if (!source) return fail(source.error());
  const auto target = prepare_map(copies.target, resolution, all_threads());
  if (!target) return fail(target.error());
  AlignPage page{wanted.target.empty() ? "the map" : wanted.target,
                 wanted.source,
                 result.evidence.message,
                 &*target,
                 &*source,
                 wanted.T_target_source.value_or(Transform::Identity()),
                 result.evidence.T_target_source};
  const auto drawn = write_align_page(page, wanted.picture);
  if (!drawn) return fail(drawn.error());
  return {};
}

}  // namespace

Outcome align_live(const AlignLive& wanted, const Common& common) {
  for (const std::string& name : {wanted.source, wanted.target, wanted.id}) {
    if (!name.empty() && !is_name(name)) return bad_name(name);
  }
  Live live(common);
  const AlignRequest request{live.id_or_new(wanted.id),
                             author_or_user(wanted.author),
                             wanted.source,
                             "",
                             wanted.target,
                             "",
                             wanted.T_target_source,
                             live.bus().now()};
  const auto result = request_alignment(live, request);
  if (!result) return tl::unexpected(result.error());
  nlohmann::json object = to_json(*result);
  std::string words = to_words(*result);
  // A picture that fails keeps nobody from what was found: it is said, and accepted, before anything is drawn.
  std::optional<tl::expected<Copies, Failure>> copies;
  if (!wanted.picture.empty()) copies = copy_both(wanted, common);
  if (result->evidence.accepted() && wanted.accept) {
    const AlignDecision decision{live.new_id(), request.author, AlignDecision::Op::kAccept, request.id,
                                 live.bus().now()};
    const auto answer = decide(live, decision);
    if (!answer) return tl::unexpected(answer.error());
    object["placement"] = to_json(*answer);
    words += "\n" + answer->message + "; take it back with: concord undo " + answer->id;
  } else if (result->open) {
    words += "\nput it into the map with: concord alignment accept " + result->id;
  }
  common.print(object, words);
  const Exit exit = result->evidence.accepted() ? Exit::kDone : Exit::kRefused;
  if (!copies) return exit;
  const auto drawn =
      copies->and_then([&](const Copies& both) { return draw(wanted, both, live.site().resolution, *result); });
  return drawn ? exit : say_undrawn(drawn.error(), exit);
}

Outcome decide_alignment(const std::string& align_id, bool accept, const std::string& author, const std::string& id,
                         const Common& common) {
  if (!id.empty() && !is_name(id)) return bad_name(id);
  if (!is_request_id(align_id)) return fail(Exit::kUnusable, "BAD_NAME", "an id is 1 to 80 printable characters");
  Live live(common);
  const AlignDecision decision{live.id_or_new(id), author_or_user(author),
                               accept ? AlignDecision::Op::kAccept : AlignDecision::Op::kDrop, align_id,
                               live.bus().now()};
  auto answer = decide(live, decision);
  if (answer && accept) answer->message += "; take it back with: concord undo " + answer->id;
  return print_revision(answer, common);
}

Outcome list_alignments(const Common& common) {
  Live live(common);
  std::map<std::string, AlignResult> heard;
  bool is_there = false;
  live.hear<AlignResult>(kResults, [&](const std::string&, AlignResult result) {
    const std::string id = result.id;
    if (result.open || result.author.empty()) heard.insert_or_assign(id, std::move(result));
  });
  live.hear<ProcessStatus>("out/status/align", [&](const std::string&, const ProcessStatus&) { is_there = true; });
  live.wait(kListen, [] { return false; });
  if (!is_there) return live.no_answer("align");
  nlohmann::json array = nlohmann::json::array();
  std::vector<std::vector<std::string>> rows = {{"id", "who asked", "what", "overlap", "slip", "in words"}};
  for (const auto& [id, result] : heard) {
    array.push_back(to_json(result));
    rows.push_back({id, result.author.empty() ? "the watch" : result.author, pair_of(result),
                    format_number(100.0 * result.evidence.overlap(), 0) + " %",
                    result.author.empty() ? format_number(result.slip, 2) + " m" : "", result.evidence.message});
  }
  common.print({{"alignments", array}}, heard.empty() ? "no alignment waits to be accepted, and nobody has slipped"
                                                      : format_table(rows, "lllrrl"));
  return Exit::kDone;
}

}  // namespace concord
