// zone, zones: what people fenced off or opened to contact.

#include <memory>

#include <nlohmann/json.hpp>

#include "cli/extent.hpp"
#include "cli/list_copy.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "cli/selection_options.hpp"
#include "cli/table.hpp"
#include "cli/times.hpp"

namespace concord {
namespace {

struct Options {
  std::string op, name, author, id;
  bool no_go = false, allow_contact = false, corridor = false;
  int cost = 0;
  double margin = 0.0;
  SelectionOptions selection;
  std::int64_t base_revision = kAnyRevision;
};

ZoneRequest::Op op_of(const std::string& word) {
  if (word == "add") return ZoneRequest::Op::kAdd;
  return word == "change" ? ZoneRequest::Op::kChange : ZoneRequest::Op::kDelete;
}

/// Nothing unless one of them was said.
std::optional<Zone::Kind> kind_of(const Options& options) {
  std::optional<Zone::Kind> kind;
  int said = 0;
  const auto take = [&](bool is_it, Zone::Kind one) {
    if (!is_it) return;
    kind = one;
    ++said;
  };
  take(options.no_go, Zone::Kind::kNoGo);
  take(options.allow_contact, Zone::Kind::kAllowContact);
  take(options.cost != 0, Zone::Kind::kCostly);
  take(options.corridor, Zone::Kind::kCorridor);
  return said == 1 ? kind : std::nullopt;
}

/// The part of a request that says what the zone is.
Result<void> describe(const Options& options, ZoneRequest& request) {
  // Whatever a zone that is there was called, it can be changed and deleted.
  if (request.op == ZoneRequest::Op::kAdd && !is_title(options.name)) {
    return refuse(Code::kBadName, std::string("a zone's name is ") + kTitleRule);
  }
  if (request.op == ZoneRequest::Op::kDelete) {
    const bool is_kind_given = options.no_go || options.allow_contact || options.corridor || options.cost != 0;
    if (!is_kind_given && options.margin == 0 && !is_given(options.selection)) return {};
    return refuse(Code::kBadRequest, "zone delete takes the name alone");
  }
  const std::optional<Zone::Kind> kind = kind_of(options);
  if (!kind) return refuse(Code::kBadRequest, "say one of --no-go, --allow-contact, --costly and --corridor");
  request.kind = *kind;
  request.margin = options.margin;
  request.cost = options.cost;
  if (const auto fine = check_terms(request.kind, request.margin, request.cost); !fine) return fine;
  return volume_of(options.selection).map([&](Volume volume) { request.volume = std::move(volume); });
}

std::string terms_of(const Zone& zone) {
  std::string text = zone.cost != 0 ? "+" + std::to_string(zone.cost) + " a metre" : "";
  if (zone.margin != 0) text += (text.empty() ? "" : ", ") + format_number(zone.margin, 2) + " m around";
  return text;
}

Outcome zone(const Options& options, const Common& common) {
  if (const auto fine = check_own_id(options.id); !fine) return fail(fine.error());
  ZoneRequest request;
  request.op = op_of(options.op);
  if (const auto described = describe(options, request); !described) return fail(described.error());
  Live live(common);
  request.id = live.id_or_new(options.id);
  request.author = author_or_user(options.author);
  request.name = options.name;
  request.frame = options.selection.frame;
  request.base_revision = options.base_revision;
  request.utime = live.bus().now();
  return print_revision(live.ask("in/zone", request), common);
}

Outcome zones(const Common& common) {
  Live live(common);
  ListCopy<Zone> copy(live, "merge", "out/zones");
  const auto list = copy.wait_synced(live);
  if (!list) return tl::unexpected(list.error());
  nlohmann::json array = nlohmann::json::array();
  std::vector<std::vector<std::string>> rows = {
      {"name", "kind", "terms", "shape", kExtentHeading, "who", "time", "revision"}};
  for (const Zone& zone : *list) {
    const Box around = extent(zone.volume, zone.T_map_zone);
    array.push_back({{"name", zone.name},
                     {"kind", name(zone.kind)},
                     {"margin", zone.margin},
                     {"cost", zone.cost},
                     {"volume", to_json(zone.volume, zone.T_map_zone)},
                     {"bounds", to_json(around)},
                     {"author", zone.author},
                     {"utime", zone.utime},
                     {"time", format_utc_time(zone.utime)},
                     {"revision", zone.revision}});
    rows.push_back({zone.name, name(zone.kind), terms_of(zone), kind_of(zone.volume), to_words(around), zone.author,
                    format_local_time(zone.utime), std::to_string(zone.revision)});
  }
  common.print({{"zones", array}}, list->empty() ? "no zones" : format_table(rows, "lllllllr"));
  return Exit::kDone;
}

}  // namespace

void add_zones(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command =
      program.add("zone", "fences a volume off for planning, or opens it to contact: map data, no safety function",
                  [options](const Common& common) { return zone(*options, common); });
  command.add_option("op", options->op, "add, change or delete")
      ->required()
      ->check(CLI::IsMember({"add", "change", "delete"}));
  command.add_option("name", options->name, "the zone's name")->required();
  auto* no_go = command.add_flag("--no-go", options->no_go, "no robot plans through it; outranks --allow-contact");
  command.add_flag("--allow-contact", options->allow_contact, "robots may touch what is there")->excludes(no_go);
  command.add_option("--costly", options->cost, "a metre through it costs so many more than one elsewhere, 1 to 15");
  command.add_flag("--corridor", options->corridor, "ways beside all corridors cost sixteen times as much");
  command.add_option("--margin", options->margin,
                     "metres around the volume, level, 0 to 10; of a no-go or costly zone");
  add_volume_options(command, options->selection);
  command
      .add_option("--base-revision", options->base_revision,
                  "the revision that was seen: change and delete are refused if the zone was changed since")
      ->check(CLI::NonNegativeNumber);
  command.add_option("--author", options->author, "who asks; without it $USER");
  command.add_option("--id", options->id, "of this request: asked again with it, it is done once");

  program.add("zones", "every zone", zones);
}

}  // namespace concord
