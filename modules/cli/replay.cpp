#include "cli/replay.hpp"

#include <array>
#include <ctime>
#include <memory>

#include <nlohmann/json.hpp>

#include "cli/numbers.hpp"
#include "cli/replay_expected.hpp"

namespace concord {
namespace {

constexpr std::int64_t kLongestJump = std::int64_t{24} * 3600 * 1'000'000;

struct Options {
  std::string log;
  bool live = false;
  std::string expect;
};

nlohmann::json to_json(const StreamGaps::Gap& gap) {
  return {{"channel", gap.channel},
          {"missing", gap.missing ? nlohmann::json(*gap.missing) : nlohmann::json()},
          {"what", gap.what}};
}

nlohmann::json to_json(const LogCut& cut) {
  return {{"whole_events", cut.whole_events}, {"byte", cut.byte}, {"bytes_lost", cut.bytes_lost}};
}

nlohmann::json to_json(const Replayed& replayed) {
  nlohmann::json gaps = nlohmann::json::array();
  for (const StreamGaps::Gap& gap : replayed.gaps) gaps.push_back(to_json(gap));
  nlohmann::json results;
  for (const auto& [name, digest] : replayed.digests) results[name] = hex(digest);
  const std::string map = hex(replayed.digests.at("map"));
  return {{"digest", map},
          {"map_digest", map},
          {"results", results},
          {"gaps", gaps},
          {"cut", replayed.cut ? to_json(*replayed.cut) : nlohmann::json()},
          {"messages", replayed.messages},
          {"seconds", replayed.seconds}};
}

std::string words(const Replayed& replayed, const nlohmann::json& result) {
  std::string text = format_count(replayed.messages) + " messages in " + format_number(replayed.seconds, 0) +
                     " s, map of " + format_count(static_cast<std::int64_t>(replayed.map_bricks)) + " bricks\n";
  for (const auto& [name, digest] : replayed.digests)
    text += name + std::string(12 - name.size(), ' ') + hex(digest) + "\n";
  if (replayed.cut) {
    text += "cut         the log breaks off within an event at byte " + std::to_string(replayed.cut->byte) + "; the " +
            format_count(replayed.cut->whole_events) + " whole events before it were played, " +
            format_count(static_cast<std::int64_t>(replayed.cut->bytes_lost)) + " bytes were not\n";
  }
  for (const StreamGaps::Gap& gap : replayed.gaps) {
    text +=
        "gap         " + gap.channel + ": " + (gap.missing ? format_count(*gap.missing) + " " : "") + gap.what + "\n";
  }
  if (!result.contains("differences")) return text;
  for (const auto& line : result["differences"]) text += "different   " + line.get<std::string>() + "\n";
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
  std::optional<Expected> expected;  // read first: a replay may take minutes
  if (!options.expect.empty()) {
    auto read = Expected::read(options.expect, options.live);
    if (!read) return fail(read.error());
    expected = std::move(*read);
  }
  const auto replayed = options.live ? replay_live(options.log, site) : replay_lockstep(options.log, site);
  if (!replayed) return tl::unexpected(replayed.error());
  nlohmann::json result = to_json(*replayed);
  bool differs = false;
  if (expected) {
    const std::vector<std::string> differences = expected->differences(result);
    differs = !differences.empty();
    result["differences"] = differences;
  }
  common.print(result, words(*replayed, result));
  if (!replayed->gaps.empty() || replayed->cut) return Exit::kIncomplete;
  return differs ? Exit::kNegative : Exit::kDone;
}

/// "2026-11-22 07:15:00.123456 UTC", as `date` reads it.
std::string date(std::int64_t utime) {
  const std::time_t seconds = utime / 1'000'000;
  std::tm day = {};
  if (gmtime_r(&seconds, &day) == nullptr) return "microsecond " + std::to_string(utime);
  std::array<char, 64> text;
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S", &day);
  std::string fraction = std::to_string(1'000'000 + utime % 1'000'000);
  fraction[0] = '.';
  return std::string(text.data(), size) + fraction + " UTC";
}

}  // namespace

Result<std::optional<LogCut>> each_input(const std::filesystem::path& log,
                                         const std::function<void(const LogEvent&)>& take) {
  auto reader = LogReader::open(log);
  if (!reader) return tl::unexpected(reader.error());
  std::int64_t latest = -1, taken = 0;
  while (true) {
    const std::uintmax_t begin = reader->at();
    const auto event = reader->next();
    if (!event) return tl::unexpected(event.error());
    if (!*event) break;
    const std::int64_t utime = (*event)->utime;
    if (latest >= 0 && utime - latest > kLongestJump) {
      return refuse(Code::kMalformed, log.string() + ": its clock jumps by more than a day at event " +
                                          std::to_string(reader->events()) + ", byte " + std::to_string(begin) +
                                          ": from " + date(latest) + " to " + date(utime) + "; cut it there: head -c " +
                                          std::to_string(begin) + " LOG >BEFORE");
    }
    latest = std::max(latest, utime);
    if (!(*event)->channel.starts_with("in/") || !is_channel((*event)->channel)) continue;
    take(**event);
    ++taken;
  }
  if (taken > 0) return reader->cut();
  const std::int64_t events = reader->events();
  return refuse(
      Code::kEmpty,
      log.string() + " holds nothing to play: " +
          (events == 0 ? "no whole event" : "none of its " + format_count(events) + " events is on an in/ channel"));
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
