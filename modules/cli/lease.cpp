// lease, leases: regions that people hold while they work in them.

#include <cmath>
#include <memory>

#include <nlohmann/json.hpp>

#include "cli/end_request.hpp"
#include "cli/extent.hpp"
#include "cli/list_copy.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"
#include "cli/selection_options.hpp"
#include "cli/table.hpp"
#include "cli/times.hpp"

namespace concord {
namespace {

constexpr double kRenew = 3.0;     // seconds; it ends 10 s after it was held last
constexpr double kFarewell = 2.0;  // seconds to be freed in, after which it is left to end by itself

struct Options {
  std::string op, lease, author;
  std::optional<double> seconds;
  SelectionOptions selection;
};

/// Each time by an id of its own: what a lease is called others may use too, and their answers are not ours.
tl::expected<Answer, Failure> ask(Live& live, LeaseRequest& request) {
  request.id = live.new_id();
  request.utime = live.bus().now();
  return live.ask("in/lease", request);
}

/// Also when a person has ended the program, which no other wait outlasts. Returns whether it is freed.
bool free_at_the_end(Live& live, LeaseRequest& request) {
  request.hold = false;
  request.id = live.new_id();
  request.utime = live.bus().now();
  const auto freed = std::make_shared<bool>(false);  // the subscription outlives this call
  live.hear<Answer>(kAnswers, [freed, id = request.id](const std::string&, const Answer& answer) {
    *freed = *freed || (answer.ok && answer.id == id);
  });
  const std::int64_t end = request.utime + std::llround(kFarewell * 1e6);
  for (std::int64_t due = 0; !*freed && live.bus().now() < end; live.bus().spin_once(10)) {
    if (live.bus().now() < due) continue;
    live.bus().publish("in/lease", encode(request));
    due = live.bus().now() + kAskAgain;
  }
  return *freed;
}

/// Whether its holder has freed it meanwhile, by another client: to renew it would take it again.
std::shared_ptr<bool> watch_for_free(Live& live, const LeaseRequest& request) {
  auto freed = std::make_shared<bool>(false);
  live.hear<LeaseRequest>("in/lease", [freed, lease = request.lease, author = request.author](
                                          const std::string&, const LeaseRequest& heard) {
    *freed = *freed || (!heard.hold && heard.lease == lease && heard.author == author);
  });
  return freed;
}

Outcome hold(const Options& options, LeaseRequest request, const Common& common) {
  Live live(common);
  if (options.seconds) end_on_signals();
  auto held = ask(live, request);
  if (!held || !options.seconds) return print_answer(held, common);
  if (!common.json) {
    std::fprintf(stderr, "lease %s is held for %s s; Ctrl-C frees it\n", request.lease.c_str(),
                 format_number(*options.seconds, 0).c_str());
  }
  const auto freed_elsewhere = watch_for_free(live, request);
  const std::int64_t end = live.bus().now() + std::llround(*options.seconds * 1e6);
  const auto goes_on = [&] { return live.bus().now() < end && !end_requested() && !*freed_elsewhere; };
  while (held && goes_on()) {
    live.wait(std::min(kRenew, static_cast<double>(end - live.bus().now()) / 1e6), [&] { return *freed_elsewhere; });
    if (goes_on()) held = ask(live, request);
  }
  const bool is_freed_elsewhere = *freed_elsewhere;  // before our own word is heard
  if (!held && !end_requested() && !is_freed_elsewhere) return tl::unexpected(held.error());
  // Also where another client did: a renewal of ours may have come after that.
  const bool freed = free_at_the_end(live, request);
  if (is_freed_elsewhere) {
    return fail(
        Exit::kRefused, "FREED",
        "lease " + request.lease + " was freed by another client of " + request.author + "'s: it is not held any more");
  }
  common.print({{"id", request.lease}, {"freed", freed}},
               "lease " + request.lease + (freed ? " is freed" : " ends by itself in some seconds: nobody answered"));
  return Exit::kDone;
}

Outcome lease(const Options& options, const Common& common) {
  if (const auto fine = check_id(options.lease); !fine) return fail(fine.error());
  LeaseRequest request;
  request.lease = options.lease;
  request.author = author_or_user(options.author);
  request.hold = options.op == "hold";
  request.frame = options.selection.frame;
  if (!request.hold) {
    if (options.seconds || is_given(options.selection)) {
      return fail(Exit::kUnusable, "BAD_REQUEST", "lease free takes the id alone");
    }
    Live live(common);
    return print_answer(ask(live, request), common);
  }
  if (options.seconds && !std::isfinite(*options.seconds)) {  // CLI11 takes NaN for in range
    return fail(Exit::kUnusable, name(Code::kNotFinite), "--for takes a number of seconds");
  }
  auto volume = volume_of(options.selection);
  if (!volume) return fail(volume.error());
  request.volume = std::move(*volume);
  return hold(options, std::move(request), common);
}

Outcome leases(const Common& common) {
  Live live(common);
  ListCopy<Lease> copy(live, "merge", "out/leases");
  const auto list = copy.wait_synced(live);
  if (!list) return tl::unexpected(list.error());
  nlohmann::json array = nlohmann::json::array();
  std::vector<std::vector<std::string>> rows = {{"id", "who", "shape", kExtentHeading, "until"}};
  for (const Lease& lease : *list) {
    const Box around = extent(lease.volume, lease.T_map_lease);
    array.push_back({{"id", lease.id},
                     {"author", lease.author},
                     {"volume", to_json(lease.volume, lease.T_map_lease)},
                     {"bounds", to_json(around)},
                     {"until", lease.until}});
    rows.push_back({lease.id, lease.author, kind_of(lease.volume), to_words(around), format_local_time(lease.until)});
  }
  common.print({{"leases", array}}, list->empty() ? "no leases" : format_table(rows, "lllll"));
  return Exit::kDone;
}

}  // namespace

void add_leases(Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App& command = program.add("lease", "holds a region while someone works in it: others are refused there",
                                  [options](const Common& common) { return lease(*options, common); });
  command.add_option("op", options->op, "hold for 10 s, or free")->required()->check(CLI::IsMember({"hold", "free"}));
  command.add_option("id", options->lease, "the lease's: held again, it is renewed, and may move")->required();
  add_volume_options(command, options->selection);
  command.add_option("--for", options->seconds, "seconds: renews it until then or Ctrl-C, then frees it")
      ->check(CLI::Range(1.0, 86'400.0));
  command.add_option("--author", options->author, "who holds it; without it $USER");

  program.add("leases", "the regions that are held now", leases);
}

}  // namespace concord
