#include "cli/demo_run.hpp"

#include <algorithm>
#include <cstdio>

#include "cli/end_request.hpp"
#include "cli/map_file.hpp"
#include "cli/numbers.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

constexpr double kListen = 1.3;  // seconds in which a process that runs says its status
constexpr double kStart = 30.0;  // seconds, as all below
constexpr double kMapping = 600.0;
constexpr double kSync = 120.0;
constexpr double kProgress = 2.0;
constexpr double kAgain = 0.2;
constexpr double kCoarse = 0.5;   // metres; of points that nobody looks at
constexpr double kMoments = 1.0;  // between two of them: agents say once a second how far they are

bool nonempty(const fs::path& file) {
  std::error_code error;
  return fs::file_size(file, error) > 0 && !error;
}

}  // namespace

DemoRun::Copies::Copies(Live& live, const DemoScene& scene) : map(live, "out/map"), conflicts(live, "out/conflicts") {
  for (const DemoAgent& agent : scene.agents) {
    agents[agent.id] = std::make_unique<StreamCopy>(live, "out/agent/" + agent.id);
  }
}

DemoRun::DemoRun(const DemoOptions& options, const Common& common)
    : options_(options), folder_{options.out}, common_(common), supervisor_([this](const std::string& line) {
        say(line);
      }) {}

Outcome DemoRun::run() {
  end_on_signals();
  for (const auto step : {&DemoRun::prepare, &DemoRun::start, &DemoRun::send, &DemoRun::follow_mapping,
                          &DemoRun::drive_to_start, &DemoRun::plan_before, &DemoRun::edit, &DemoRun::plan_after,
                          &DemoRun::arrive, &DemoRun::collect, &DemoRun::tell}) {
    const Step done = (this->*step)();
    if (end_requested()) return fail(Exit::kIncomplete, "INTERRUPTED", "ended before the report was written");
    if (!done) return tl::unexpected(done.error());
  }
  if (!options_.headless) show();
  return report_.streams_whole ? Exit::kDone : Exit::kIncomplete;
}

DemoRun::Step DemoRun::prepare() {
  const Site given = common_.site();
  auto scene = make_scene(options_, given);
  if (!scene) return fail(scene.error());
  scene_ = std::move(*scene);

  std::vector<fs::path> inputs(options_.maps.begin(), options_.maps.end());
  if (!common_.site_file.empty()) inputs.emplace_back(common_.site_file);
  auto made = folder_.prepare(inputs);
  if (!made) return not_started(made.error());
  folder_lock_ = std::move(*made);
  const auto written = write_file(folder_.site(), to_yaml(demo_site(scene_, given, folder_.state())));
  if (!written) return fail(written.error());
  common_.site_file = folder_.site();
  return {};
}

DemoRun::Step DemoRun::start() {
  const double since = now();
  live_ = std::make_unique<Live>(common_);
  watch_ = std::make_unique<DemoWatch>(*live_, scene_);
  live_->wait(kListen, [this] { return watch_->anyone().has_value(); });
  if (const auto other = watch_->anyone()) {
    return fail(Exit::kRefused, "EXISTS",
                *other + " runs already on " + live_->site().lcm_url + "; end that stack first");
  }
  copies_ = std::make_unique<Copies>(*live_, scene_);
  live_->bus().every(100'000, [this] { supervisor_.wait(std::chrono::milliseconds(0)); });

  const fs::path log = folder_.log();
  const Site& site = live_->site();
  auto started = start_stack(supervisor_, {common_.site_file, site.lcm_url, site.state, log, folder_.output(), true});
  if (!started) return not_started(started.error());
  stack_lock_ = std::move(*started);
  const auto up = wait_for("the processes to start", kStart, [&] {
    return nonempty(log) && watch_->runs("hmd-bridge") &&
           std::ranges::all_of(kStackProcesses, [&](const char* p) { return watch_->runs(p); });
  });
  if (!up) return up;
  say("ingest, merge, align, planner and the headsets' bridge run; lcm-logger writes " + log.string());
  took("start", since);
  return enter_bridge();
}

DemoRun::Step DemoRun::enter_bridge() {
  auto person = DemoPerson::enter(*live_, scene_.author);
  if (!person) return tl::unexpected(person.error());
  person_ = std::move(*person);
  say("look, and take part: " + person_->page());
  return {};
}

DemoRun::Step DemoRun::send() {
  for (const DemoAgent& agent : scene_.agents) {
    if (agent.file) {
      watch_->publish(*live_, agent);
      continue;
    }
    const auto started = supervisor_.start(
        {.name = agent.id,
         .command = {program_folder() / "concord-sim-agent", "--site", common_.site_file, "--agent", agent.id, "--kind",
                     agent.kind, "--seed", std::to_string(options_.seed), "--speed", format_number(options_.speed, 3)},
         .output = folder_.output() / (agent.id + ".txt")});
    if (!started) return fail(started.error());
  }
  say(options_.maps.empty() ? "a robot, a cart and a headset set out in the warehouse" : "both maps are on their way");
  return {};
}

DemoRun::Step DemoRun::follow_mapping() {
  const double since = now();
  double next_line = since, next_moment = since;
  const auto done = [this] {
    return std::ranges::all_of(scene_.agents, [this](const DemoAgent& agent) { return watch_->finished(agent); });
  };
  while (!done()) {
    if (now() > since + kMapping) return fail(Exit::kIncomplete, "INCOMPLETE", "the agents did not finish in time");
    live_->wait(0.3, end_requested);
    if (const Step fine = check("the agents"); !fine) return fine;
    // A copy: the list is replaced while an alignment waits for its answer.
    const std::vector<AgentState> states = watch_->agents();
    for (const AgentState& state : states) {
      if (state.aligned) continue;
      if (const Step aligned = align(state); !aligned) return aligned;
    }
    if (now() >= next_moment) {
      next_moment = now() + kMoments;
      note_moment();
    }
    if (now() < next_line) continue;
    next_line = now() + kProgress;
    say_progress();
  }
  took("mapping", since);
  const Step settled = settle("before_edit");
  note_moment();
  return settled;
}

void DemoRun::note_moment() {
  if (!scene_.world) return;
  const auto on_its_way = [this](const DemoAgent& agent) {
    return agent.way_seconds * static_cast<double>(watch_->progress(agent)) / 100;
  };
  const DemoAgent& robot = scene_.agents.front();
  double longest = 0;
  for (const DemoAgent& agent : scene_.agents) longest = std::max(longest, on_its_way(agent));
  moments_.push_back({longest, on_its_way(robot), occupied_part(copies_->map.map()),
                      occupied_part(copies_->agents.at(robot.id)->map())});
}

void DemoRun::say_progress() const {
  std::string line;
  for (const DemoAgent& agent : scene_.agents) {
    line += agent.id + " " + std::to_string(watch_->progress(agent)) + " %   ";
  }
  say(line + "map " + format_count(static_cast<std::int64_t>(copies_->map.map().known_count())) + " voxels");
}

DemoRun::Step DemoRun::align(const AgentState& state) {
  const auto agent = std::ranges::find(scene_.agents, state.id, &DemoAgent::id);
  if (agent == scene_.agents.end()) return {};
  if (const Step placed = person_->place(state.id, agent->T_map_agent); !placed) return placed;
  say(state.id + " is aligned where it is known to have started");
  watch_->note_aligned(state.id, agent->T_map_agent);
  return {};
}

DemoRun::Step DemoRun::all_taken_in() {
  std::map<std::string, std::int64_t> since;
  for (const DemoAgent& agent : scene_.agents) {
    if (!watch_->sends_clouds(agent)) continue;
    // Ingest answers in the order in which it hears: what was sent before this question is in the layer.
    const DownsampleRequest request{live_->new_id(), agent.id, kCoarse};
    const auto answer = live_->ask("in/downsample", request);
    if (!answer) return tl::unexpected(answer.error());
    since[agent.id] = live_->bus().now();
  }
  return wait_for("all that was sent to be merged", kSync, [&] {
    return std::ranges::all_of(scene_.agents, [&](const DemoAgent& agent) {
      const AgentState* merged = watch_->state_of(agent.id);
      const std::int64_t revision = watch_->revision(agent);
      return watch_->finished(agent) && watch_->taken_in(agent, since[agent.id]) && merged->synced &&
             merged->revision == revision && copies_->agents.at(agent.id)->synced() &&
             copies_->agents.at(agent.id)->revision() == revision;
    });
  });
}

tl::expected<std::int64_t, Failure> DemoRun::save(const std::string& name) {
  const double end = now() + kSync;
  for (;;) {
    const MapRequest request{live_->new_id(), MapRequest::Op::kSave, name, {"bt"}, true, ""};
    const auto answer = live_->ask("in/map_request", request);
    if (answer) return answer->revision;
    // A merge that was started again waits for its layers first.
    if (answer.error().code != concord::name(Code::kBusy) || now() > end) return tl::unexpected(answer.error());
    live_->wait(kAgain, end_requested);
    if (const Step fine = check("the map"); !fine) return tl::unexpected(fine.error());
  }
}

DemoRun::Step DemoRun::settle(const std::string& name) {
  if (const Step taken = all_taken_in(); !taken) return taken;
  const auto saved = save(name);  // it folds what is left, and says which revision that is
  if (!saved) return tl::unexpected(saved.error());
  return wait_for("the map", kSync, [&] { return copies_->map.synced() && copies_->map.revision() >= *saved; });
}

DemoRun::Step DemoRun::check(const std::string& what) const {
  if (end_requested()) return fail(Exit::kIncomplete, "INTERRUPTED", "interrupted while waiting for " + what);
  if (const auto name = supervisor_.unusable()) {
    return fail(Exit::kUnusable, "CONFIGURATION",
                *name + " cannot use its configuration; see " + folder_.output().string());
  }
  return {};
}

DemoRun::Step DemoRun::wait_for(const std::string& what, double seconds, const std::function<bool()>& done) {
  live_->wait(seconds, [&] { return supervisor_.unusable() || done(); });
  if (const Step fine = check(what); !fine) return fine;
  if (done()) return {};
  return fail(Exit::kNoAnswer, "NO_ANSWER", "waited in vain for " + what + "; see " + folder_.output().string());
}

double DemoRun::now() const { return std::chrono::duration<double>(Supervisor::Clock::now() - began_).count(); }

void DemoRun::say(const std::string& line) const { std::fprintf(stderr, "[%5.1f s] %s\n", now(), line.c_str()); }

}  // namespace concord
