#include "cli/replay.hpp"

#include <cmath>
#include <fstream>
#include <memory>

#include <nlohmann/json.hpp>

#include "cli/live.hpp"
#include "cli/numbers.hpp"

namespace concord {
namespace {

constexpr std::int64_t kLongestJump = std::int64_t{24} * 3600 * 1'000'000;

struct Options {
  std::string log;
  bool live = false;
  std::string expect;
};

nlohmann::json to_json(const Replayed& replayed, bool live) {
  nlohmann::json gaps = nlohmann::json::array();
  for (const StreamGaps::Gap& gap : replayed.gaps) gaps.push_back({{"channel", gap.channel}, {"missing", gap.missing}});
  nlohmann::json results;
  for (const auto& [name, digest] : replayed.digests) results[name] = hex(digest);
  const std::string map = hex(replayed.digests.at("map"));
  nlohmann::json object = {{"map_digest", map},
                           {"results", results},
                           {"gaps", gaps},
                           {"messages", replayed.messages},
                           {"seconds", replayed.seconds}};
  if (!live) object["digest"] = map;
  return object;
}

/// What the file says must come out and did not.
Result<std::vector<std::string>> differences(const std::filesystem::path& file, const nlohmann::json& result) {
  std::ifstream in(file);
  const auto expected = in ? nlohmann::json::parse(in, nullptr, false) : nlohmann::json();
  if (!expected.is_object()) return refuse(Code::kIo, file.string() + " holds no JSON object");
  std::vector<std::string> found;
  const auto compare = [&](const std::string& name, const nlohmann::json& want, const nlohmann::json& have) {
    if (want != have) found.push_back(name + " is " + have.dump() + ", expected " + want.dump());
  };
  std::size_t compared = 0;
  for (const char* key : {"digest", "map_digest"}) {
    if (!expected.contains(key) || !result.contains(key)) continue;
    compare(key, expected[key], result[key]);
    ++compared;
  }
  // Live, paths depend on when the map reached the planner: only the map must be equal.
  if (expected.contains("results") && result.contains("digest")) {
    for (const auto& [key, want] : expected["results"].items()) {
      compare(key, want, result["results"].value(key, nlohmann::json()));
      ++compared;
    }
  }
  if (compared == 0) return refuse(Code::kEmpty, file.string() + " says nothing of what a replay leads to");
  return found;
}

std::string words(const nlohmann::json& result, const std::vector<std::string>& differing, std::size_t bricks) {
  std::string text = result["messages"].dump() + " messages in " +
                     std::to_string(std::lround(result["seconds"].get<double>())) + " s, map of " +
                     std::to_string(bricks) + " bricks\n";
  for (const auto& [name, digest] : result["results"].items()) {
    text += name + std::string(12 - name.size(), ' ') + digest.get<std::string>() + "\n";
  }
  for (const auto& gap : result["gaps"]) {
    text += "gap         " + gap["channel"].get<std::string>() + ": " + gap["missing"].dump() + " missing\n";
  }
  for (const std::string& line : differing) text += "different   " + line + "\n";
  return text;
}

/// A log means what it says only at the site it was recorded at: the site file beside it, if no other is named.
Site site_of(const Options& options, const Common& common) {
  const std::filesystem::path beside = std::filesystem::path(options.log).parent_path() / "site.yaml";
  std::error_code error;
  if (common.site_file.empty() && std::filesystem::exists(beside, error)) return load_site(beside);
  return common.site();
}

Outcome replay(const Options& options, const Common& common) {
  const Site site = site_of(options, common);
  const auto replayed = options.live ? replay_live(options.log, site) : replay_lockstep(options.log, site);
  if (!replayed) return tl::unexpected(replayed.error());
  nlohmann::json result = to_json(*replayed, options.live);
  std::vector<std::string> differing;
  if (!options.expect.empty()) {
    auto found = differences(options.expect, result);
    if (!found) return fail(found.error());
    differing = std::move(*found);
    result["differences"] = differing;
  }
  common.print(result, words(result, differing, replayed->map_bricks));
  if (!replayed->gaps.empty()) return Exit::kIncomplete;
  return differing.empty() ? Exit::kDone : Exit::kNegative;
}

}  // namespace

Result<void> each_input(const std::filesystem::path& log, const std::function<void(const LogEvent&)>& take) {
  auto reader = LogReader::open(log);
  if (!reader) return tl::unexpected(reader.error());
  std::int64_t latest = -1;
  while (true) {
    const auto event = reader->next();
    if (!event) return tl::unexpected(event.error());
    if (!*event) return {};
    const std::int64_t utime = (*event)->utime;
    if (latest >= 0 && utime - latest > kLongestJump) {
      return refuse(Code::kMalformed, log.string() + ": its clock jumps by more than a day; cut it there");
    }
    latest = std::max(latest, utime);
    if ((*event)->channel.starts_with("in/") && is_channel((*event)->channel)) take(**event);
  }
}

void Reading::hear(const LogEvent& event) {
  if (messages_++ == 0) {
    gaps_.emplace(resolution_, event.utime);
    first_ = event.utime;
  }
  last_ = event.utime;
  gaps_->hear(event.utime, event.channel, event.bytes);
}

void Reading::into(Replayed& replayed) const {
  replayed.messages = messages_;
  replayed.seconds = static_cast<double>(last_ - first_) * 1e-6;
  if (gaps_) replayed.gaps = gaps_->gaps();
}

void add_replay(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("replay", "plays a log's in/ channels through the stack and says what comes of it",
                                  [options](const Common& common) { return replay(*options, common); });
  command.add_option("log", options->log, "recorded by lcm-logger")->required();
  auto* live = command.add_flag("--live", options->live, "with lcm-logplayer into processes, at the speed of the log");
  command
      .add_flag_callback(
          "--lockstep", [] {}, "in this process on log time: the same every time (the default)")
      ->excludes(live);
  command.add_option("--expect", options->expect, "JSON file of what must come out, as --json prints it");
}

}  // namespace concord
