#include <filesystem>
#include <limits>
#include <memory>

#include "cli/command.hpp"
#include "cli/extension.hpp"
#include "cli/history.hpp"
#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "cli/times.hpp"

namespace concord {
namespace {

struct Options {
  std::string author, subject, kind, since, until, file;
  std::int64_t after = 0;
  std::int64_t most = std::numeric_limits<std::int64_t>::max();
};

std::map<std::string, Operation::Kind> kinds() {
  std::map<std::string, Operation::Kind> all;
  for (const std::string_view name : kOperationNames) {
    const Operation::Kind kind = *operation_called(name);
    all[word_for(kind)] = kind;
  }
  return all;
}

Result<HistoryRequest> request_of(const Options& options, std::int64_t now) {
  HistoryRequest request;
  request.author = options.author;
  request.subject = options.subject;
  if (!options.kind.empty()) request.kind = kinds().at(options.kind);
  request.after_revision = options.after;
  for (const auto& [text, time] : {std::pair(&options.since, &request.since), {&options.until, &request.until}}) {
    if (text->empty()) continue;
    const auto utime = parse_time(*text, now);
    if (!utime) return tl::unexpected(utime.error());
    *time = *utime;
  }
  return request;
}

Outcome export_to(const std::string& file, const std::vector<Operation>& operations, double resolution,
                  const Common& common) {
  const bool as_csv = extension_of(file) == ".csv";
  const auto written = write_file(
      file, as_csv
                ? to_csv(operations, resolution)
                : to_json(operations, resolution).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  if (!written) return fail(written.error());
  common.print({{"operations", operations.size()}, {"file", file}},
               format_count(static_cast<std::int64_t>(operations.size())) + " operations written to " + file);
  return Exit::kDone;
}

Outcome history(const Options& options, const Common& common) {
  const std::string extension = extension_of(options.file);
  if (!options.file.empty() && extension != ".csv" && extension != ".json") {
    return fail(Exit::kUnusable, "BAD_NAME", options.file + " must end in .json or .csv");
  }
  Live live(common);
  auto request = request_of(options, live.bus().now());
  if (!request) return fail(request.error());
  const auto operations = request_history(live, std::move(*request), options.most);
  if (!operations) return tl::unexpected(operations.error());
  if (const auto taken = live.take_resolution(); !taken) return tl::unexpected(taken.error());
  const double resolution = live.site().resolution;
  if (!options.file.empty()) return export_to(options.file, *operations, resolution, common);
  common.print(to_json(*operations, resolution),
               operations->empty() ? "nobody has changed anything" : to_words(*operations, resolution));
  return Exit::kDone;
}

}  // namespace

void add_history(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("history", "who changed what, when: the oldest first",
                                  [options](const Common& common) { return history(*options, common); });
  command.add_option("--author", options->author, "only theirs");
  command.add_option("--of", options->subject, "only what concerns this edit, zone or agent");
  std::vector<std::string> names;
  for (const auto& [name, kind] : kinds()) names.push_back(name);
  command.add_option("--kind", options->kind, "only this")->check(CLI::IsMember(names));
  command.add_option("--since", options->since, "from then: 2026-11-22T07:15 (local; or with Z, +01:00), or 2h ago");
  command.add_option("--until", options->until, "before then");
  command.add_option("--after", options->after, "only above this revision")->check(CLI::NonNegativeNumber);
  command.add_option("--most", options->most, "at most so many, the oldest first")->check(CLI::PositiveNumber);
  command.add_option("--export", options->file, "writes a .json or .csv file instead");
}

}  // namespace concord
