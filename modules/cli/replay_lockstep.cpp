#include <stdexcept>

#include "bus/lockstep_bus.hpp"
#include "bus/process.hpp"
#include "cli/replay.hpp"
#include "cli/stack_watch.hpp"
#include "cli/temporary_folder.hpp"
#include "ingest/ingest_node.hpp"
#include "merge/merge_node.hpp"
#include "planner/planner_node.hpp"

namespace concord {
namespace {

constexpr std::int64_t kStep = 100'000;
constexpr std::int64_t kLongestEnd = std::int64_t{30} * 60 * 1'000'000;  ///< log time; a watchdog, not a result

/// The processes of a stack as nodes on one bus.
class LockstepStack {
 public:
  LockstepStack(const Site& site, std::int64_t start)
      : site_(site),
        bus_(start),
        watch_(bus_, site.resolution),
        ingest_(context("ingest", ingest_counters_)),
        merge_(context("merge", merge_counters_)),
        planner_(context("planner", planner_counters_), std::launch::deferred) {}

  void hear(const LogEvent& event) {
    bus_.advance_to(event.utime);
    bus_.publish(event.channel, event.bytes);
    bus_.deliver();
  }
  /// Runs on until nothing happens any more. Returns whether that came.
  [[nodiscard]] bool run_out() {
    const std::int64_t begin = bus_.now();
    do {
      bus_.advance_to(bus_.now() + kStep);
    } while (!watch_.quiet(begin) && bus_.now() - begin < kLongestEnd);
    return watch_.quiet(begin);
  }
  [[nodiscard]] const StackWatch& watch() const { return watch_; }

 private:
  NodeContext context(const std::string& process, Counters& counters) {
    const NodeContext context{bus_, counters, site_, process, bus_.now()};
    publish_status_each_second(context);
    return context;
  }

  const Site& site_;
  LockstepBus bus_;
  Counters ingest_counters_, merge_counters_, planner_counters_;
  StackWatch watch_;
  IngestNode ingest_;
  MergeNode merge_;
  PlannerNode planner_;
};

}  // namespace

tl::expected<Replayed, Failure> replay_lockstep(const std::filesystem::path& log, Site site) {
  try {
    const TemporaryFolder folder("concord-replay");
    site.state = folder.path();
    Reading reading(site.resolution);
    std::optional<LockstepStack> stack;
    const auto read = each_input(log, [&](const LogEvent& event) {
      if (!stack) stack.emplace(site, std::max<std::int64_t>(event.utime, 1));  // boot ids are positive
      reading.hear(event);
      stack->hear(event);
    });
    if (!read) return fail(read.error());
    if (!stack->run_out()) return fail(Exit::kIncomplete, "NOT_QUIET", "the stack did not come to rest after the log");
    Replayed replayed;
    reading.into(replayed);
    replayed.cut = *read;
    replayed.digests = stack->watch().digests();
    replayed.map_bricks = stack->watch().map_bricks();
    return replayed;
  } catch (const ConfigError&) {
    throw;
  } catch (const std::runtime_error& e) {
    return fail(Exit::kUnusable, "IO", e.what());
  }
}

}  // namespace concord
