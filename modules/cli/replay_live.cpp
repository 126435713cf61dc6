#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>

#include "bus/lcm_bus.hpp"
#include "cli/end_request.hpp"
#include "cli/map_file.hpp"
#include "cli/replay.hpp"
#include "cli/stack.hpp"
#include "cli/stack_watch.hpp"
#include "cli/temporary_folder.hpp"

namespace concord {
namespace {

constexpr std::int64_t kLongestStart = 30'000'000;
constexpr std::int64_t kLongestEnd = 600'000'000;

/// A port that nobody uses now: LCM is kept apart by port, not by group. 0 if there is none.
int free_port() {
  const int handle = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  socklen_t size = sizeof(address);
  const bool bound = handle >= 0 && bind(handle, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                     getsockname(handle, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  if (handle >= 0) close(handle);
  return bound ? ntohs(address.sin_port) : 0;
}

/// The processes, the player and our own ear.
class LiveStack {
 public:
  explicit LiveStack(const Site& site)
      : site_(site),
        supervisor_([](const std::string& line) { std::fprintf(stderr, "concord: %s\n", line.c_str()); }),
        bus_(site.lcm_url, counters_),
        watch_(bus_, site.resolution),
        heard_(site.resolution) {
    const auto hear = [this](const std::string& channel, std::span<const std::uint8_t> bytes) {
      heard_.hear({bus_.now(), channel, Bytes(bytes.begin(), bytes.end())});
    };
    bus_.subscribe("in/.*", hear);
  }

  [[nodiscard]] Result<void> start() {
    if (auto written = write_file(site_.state / "site.yaml", to_yaml(site_)); !written) return written;
    auto started = start_stack(supervisor_, {site_.state / "site.yaml", site_.lcm_url, site_.state, {}, site_.state});
    if (!started) return tl::unexpected(started.error());
    stack_lock_ = std::move(*started);
    return {};
  }
  [[nodiscard]] Result<void> play(const std::filesystem::path& log) {
    return supervisor_.start({.name = "lcm-logplayer",
                              .command = {"lcm-logplayer", "--lcm-url=" + site_.lcm_url, "--regexp=in/.*", log},
                              .output = site_.state / "lcm-logplayer.txt",
                              .restart = false});
  }
  [[nodiscard]] std::optional<int> player_exit() const { return supervisor_.exit_code("lcm-logplayer"); }
  [[nodiscard]] std::optional<std::string> unusable() const { return supervisor_.unusable(); }

  /// Serves until `done()`, at most `most` microseconds. Returns done().
  template <class Done>
  [[nodiscard]] bool wait(std::int64_t most, Done done) {
    const std::int64_t end = bus_.now() + most;
    while (!done() && bus_.now() < end && !end_requested() && !unusable()) {
      bus_.spin_once(10);
      supervisor_.wait(std::chrono::milliseconds(0));
    }
    return done();
  }
  [[nodiscard]] std::int64_t now() const { return bus_.now(); }
  [[nodiscard]] const StackWatch& watch() const { return watch_; }
  [[nodiscard]] const Reading& heard() const { return heard_; }

 private:
  const Site& site_;
  std::optional<FileLock> stack_lock_;
  Supervisor supervisor_;
  Counters counters_;
  LcmBus bus_;
  StackWatch watch_;
  Reading heard_;
};

tl::unexpected<Failure> not_awake(const LiveStack& stack) {
  if (const auto process = stack.unusable()) {
    return fail(Exit::kUnusable, "CONFIGURATION", *process + " cannot use its configuration");
  }
  return fail(Exit::kNoAnswer, "NO_ANSWER", "the stack that was started for the replay does not speak");
}

}  // namespace

tl::expected<Replayed, Failure> replay_live(const std::filesystem::path& log, Site site) {
  Reading reading(site.resolution);
  // Read whole before anything is started: a log that is no log is refused at once.
  const auto read = each_input(log, [&](const LogEvent& event) { reading.hear(event); });
  if (!read) return fail(read.error());
  Replayed replayed;
  reading.into(replayed);
  replayed.cut = *read;

  const TemporaryFolder folder("concord-replay");
  site.state = folder.path();
  site.lcm_url = "udpm://239.255.76.67:" + std::to_string(free_port()) + "?ttl=0";
  end_on_signals();
  LiveStack stack(site);
  if (const auto started = stack.start(); !started) return fail(started.error());
  if (!stack.wait(kLongestStart, [&] { return stack.watch().awake(); })) return not_awake(stack);

  if (const auto playing = stack.play(log); !playing) return fail(playing.error());
  const auto length = static_cast<std::int64_t>(replayed.seconds * 1e6);
  if (!stack.wait(2 * length + kLongestEnd, [&] { return stack.player_exit().has_value(); }) ||
      *stack.player_exit() != 0) {
    return fail(Exit::kUnusable, "PLAYER", "lcm-logplayer did not play the log to its end");
  }
  const std::int64_t played = stack.now();
  if (!stack.wait(kLongestEnd, [&] { return stack.watch().quiet(played); })) {
    return fail(Exit::kIncomplete, "NOT_QUIET", "the stack did not come to rest after the log");
  }
  replayed.digests = stack.watch().digests();
  replayed.map_bricks = stack.watch().map_bricks();
  if (!replayed.gaps.empty()) return replayed;
  // The player cannot be asked again either: what got lost between it and here may have got lost to the stack.
  Replayed heard;
  stack.heard().into(heard);
  replayed.gaps = heard.gaps;
  return replayed;
}

}  // namespace concord
