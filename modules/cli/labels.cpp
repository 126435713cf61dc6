// labels: asks what is labelled.

#include <memory>

#include "bus/messages_label.hpp"
#include "cli/arguments.hpp"
#include "cli/label_list.hpp"
#include "cli/labels_file.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "cli/semantic_commands.hpp"

namespace concord {
namespace {

struct Options {
  std::string at, of_class, within, border, out, load, author;
  bool classes = false;
};

Result<LabelQuery> query_of(const Options& options) {
  LabelQuery query;
  const int given = !options.at.empty() + !options.of_class.empty() + !options.within.empty() +
                    !options.border.empty() + options.classes;
  if (given > 1) return refuse(Code::kBadRequest, "give one of --at, --class, --within and --border");
  if (options.classes) {
    query.kind = LabelQuery::Kind::kClasses;
  } else if (!options.at.empty()) {
    query.kind = LabelQuery::Kind::kAt;
    const auto p = parse_vector(options.at);
    if (!p) return tl::unexpected(p.error());
    query.p_map = *p;
  } else if (!options.within.empty()) {
    query.kind = LabelQuery::Kind::kWithin;
    const auto numbers = parse_numbers(options.within, 4);
    if (!numbers) return tl::unexpected(numbers.error());
    query.p_map = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
    query.radius = (*numbers)[3];
  } else if (!options.of_class.empty() || !options.border.empty()) {
    query.kind = options.border.empty() ? LabelQuery::Kind::kClass : LabelQuery::Kind::kBorder;
    query.name = options.border.empty() ? options.of_class : options.border;
  }
  return query;
}

Outcome labels(const Options& options, const Common& common) {
  for (const std::string& file : {options.out, options.load}) {
    if (file.empty()) continue;
    if (const auto fine = check_labels_file(file); !fine) return fail(fine.error());
  }
  const auto query = query_of(options);
  if (!query) return fail(query.error());
  Live live(common);
  if (const auto taken = live.take_resolution(); !taken) return tl::unexpected(taken.error());
  if (!options.load.empty()) return load_labels(options.load, author_or_user(options.author), live, common);
  if (!options.out.empty()) return save_labels(options.out, live, common);
  const auto found = request_labels(live, *query);
  if (!found) return tl::unexpected(found.error());
  nlohmann::json all = nlohmann::json::array();
  for (const LabelInstance& one : *found) all.push_back(to_json(one, live.site().resolution));
  common.print({{"instances", all}},
               found->empty() ? "no label shows there" : to_words(*found, live.site().resolution));
  return Exit::kDone;
}

}  // namespace

void add_labels(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("labels", "what is labelled, and where",
                                  [options](const Common& common) { return labels(*options, common); });
  command.add_option("--at", options->at, "\"x y z\": what is there");
  command.add_option("--class", options->of_class, "all of this class");
  command.add_option("--within", options->within, "\"x y z r\": what lies within r metres of a point");
  command.add_option("--border", options->border, "the free space that things of this class border");
  command.add_flag("--classes", options->classes, "all classes that were named");
  CLI::Option* out = command.add_option("--out", options->out, "writes the map with its labels: .pcd or .ply");
  CLI::Option* load =
      command.add_option("--load", options->load, "labels the map as a file says that --out wrote, with its numbers");
  out->excludes(load);
  for (const char* query : {"--at", "--class", "--within", "--border", "--classes"}) {
    for (CLI::Option* file : {out, load}) file->excludes(command.get_option(query));
  }
  command.add_option("--author", options->author, "who loads; without it $USER");
}

}  // namespace concord
