#include "cli/demo_run.hpp"

#include <spawn.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <thread>

#include <nlohmann/json.hpp>

#include "cli/map_file.hpp"
#include "cli/page.hpp"
#include "cli/report.hpp"
#include "core/compose.hpp"

namespace concord {
namespace {

namespace fs = std::filesystem;

constexpr double kListen = 1.3;  // seconds in which a process that runs says its status
constexpr double kStart = 30.0;  // seconds, as all below
constexpr double kMapping = 600.0;
constexpr double kSettled = 1.5;  // a map that has not changed for so long is done
constexpr double kSync = 120.0;
constexpr double kReplan = 5.0;
constexpr double kProgress = 2.0;

constexpr const char* kProcesses[] = {"ingest", "merge", "planner"};

int threads() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

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
    : options_(options), common_(common), supervisor_([this](const std::string& line) { say(line); }) {}

Outcome DemoRun::run() {
  end_on_signals();
  for (const auto step :
       {&DemoRun::prepare, &DemoRun::start, &DemoRun::send, &DemoRun::follow_mapping, &DemoRun::plan_before,
        &DemoRun::edit, &DemoRun::plan_after, &DemoRun::collect, &DemoRun::tell}) {
    if (const Step done = (this->*step)(); !done) return tl::unexpected(done.error());
  }
  if (!options_.headless) show();
  return report_.complete ? Exit::kDone : Exit::kIncomplete;
}

DemoRun::Step DemoRun::prepare() {
  const Site given = common_.site_file.empty() ? Site{} : load_site(common_.site_file);
  auto scene = make_scene(options_, given);
  if (!scene) return fail(scene.error());
  scene_ = std::move(*scene);

  // What an earlier demo left, by name: the folder may hold other things.
  const fs::path& out = options_.out;
  std::error_code error;
  for (const char* name : {"demo_state", "output", "demo.lcm", "report.json", "overview.png", "map.bt", "index.html"}) {
    fs::remove_all(out / name, error);
  }
  fs::create_directories(out / "output", error);
  if (error) return fail(Exit::kUnusable, "IO", "cannot make " + out.string() + ": " + error.message());
  const std::string yaml = to_yaml(demo_site(scene_, given, out / "demo_state"));
  const auto written = write_file(out / "site.yaml", {reinterpret_cast<const std::uint8_t*>(yaml.data()), yaml.size()});
  if (!written) return fail(written.error());
  common_.site_file = out / "site.yaml";
  return {};
}

DemoRun::Step DemoRun::start() {
  const double since = now();
  live_ = std::make_unique<Live>(common_);
  watch_ = std::make_unique<DemoWatch>(*live_);
  live_->wait(kListen, [this] { return watch_->anyone().has_value(); });
  if (const auto other = watch_->anyone()) {
    return fail(Exit::kRefused, "EXISTS",
                *other + " runs already on " + live_->site().lcm_url + "; end that stack first");
  }
  copies_ = std::make_unique<Copies>(*live_, scene_);
  live_->bus().every(100'000, [this] { supervisor_.wait(std::chrono::milliseconds(0)); });

  const fs::path log = options_.out / "demo.lcm";
  const auto started =
      start_stack(supervisor_, {common_.site_file, live_->site().lcm_url, log, options_.out / "output"});
  if (!started) return fail(started.error());
  const auto up = wait_for("the processes to start", kStart, [&] {
    return nonempty(log) && std::ranges::all_of(kProcesses, [&](const char* p) { return watch_->runs(p); });
  });
  if (up) say("ingest, merge and planner run; lcm-logger writes " + log.string());
  took("start", since);
  return up;
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
         .output = options_.out / "output" / (agent.id + ".txt")});
    if (!started) return fail(started.error());
  }
  say(options_.maps.empty() ? "a robot, a cart and a headset set out in the warehouse" : "both maps are on their way");
  return {};
}

DemoRun::Step DemoRun::follow_mapping() {
  const double since = now();
  double next_line = since;
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
    if (now() < next_line) continue;
    next_line = now() + kProgress;
    std::string line;
    for (const DemoAgent& agent : scene_.agents)
      line += agent.id + " " + std::to_string(watch_->progress(agent)) + " %   ";
    say(line + "map " + format_count(static_cast<std::int64_t>(copies_->map.map().known_count())) + " voxels");
  }
  took("mapping", since);
  return settle();
}

DemoRun::Step DemoRun::align(const AgentState& state) {
  const auto agent = std::ranges::find(scene_.agents, state.id, &DemoAgent::id);
  if (agent == scene_.agents.end()) return {};
  const TransformRequest request{live_->new_id(), scene_.author, state.id, state.frame_id, agent->T_map_agent};
  const auto answer = live_->ask("in/transform", encode(request, live_->bus().now()), request.id);
  if (!answer) return tl::unexpected(answer.error());
  say(state.id + " is aligned where it is known to have started");
  watch_->note_aligned(state.id);
  return {};
}

DemoRun::Step DemoRun::settle() {
  std::int64_t revision = -1;
  double since = now();
  return wait_for("the map", kSync, [&] {
    if (!copies_->map.synced() || copies_->map.revision() != revision) {
      revision = copies_->map.revision();
      since = now();
    }
    return now() - since > kSettled;
  });
}

tl::expected<Path, Failure> DemoRun::plan(bool keep_active) {
  const double end = now() + kSync;
  for (;;) {
    PathRequest request;
    request.id = live_->new_id();
    request.robot = scene_.agents.front().id;
    request.start = *scene_.start;
    request.goal = *scene_.goal;
    request.keep_active = keep_active;
    auto path = request_path(*live_, request);
    if (!path) return path;
    // The planner copies the map as we do; it may be a moment behind.
    if (path->map_revision >= copies_->map.revision() || now() > end) {
      if (keep_active) active_path_ = request.id;
      return path;
    }
    live_->wait(0.2, [] { return false; });
  }
}

DemoRun::Step DemoRun::plan_before() {
  if (!scene_.start) return {};
  const double since = now();
  auto path = plan(true);
  if (!path) return tl::unexpected(path.error());
  took("path_before", since);
  say("before the edit: " + to_words(*path));
  report_.path_before = std::move(*path);
  return {};
}

DemoRun::Step DemoRun::edit() {
  before_edit_ = copies_->map.map();
  if (scene_.edit.empty()) return {};
  const double since = now();
  const EditRequest request{live_->new_id(), scene_.author, EditRequest::Op::kAdd, scene_.edit, live_->bus().now()};
  const auto answer = live_->ask("in/edit", encode(request, scene_.resolution), request.id);
  if (!answer) return tl::unexpected(answer.error());
  const auto shown = wait_for("the edit in the map", kSync, [this] {
    return std::ranges::all_of(scene_.edit, [&](const VoxelIndex& v) {
      const LogOdds value = copies_->map.map().at(v);
      return is_known(value) && is_occupied(value);
    });
  });
  if (!shown) return shown;
  took("edit", since);
  say("a person pinned " + format_count(static_cast<std::int64_t>(scene_.edit.size())) + " voxels");
  return {};
}

DemoRun::Step DemoRun::plan_after() {
  if (!scene_.start || scene_.edit.empty()) return {};
  const double since = now();
  const std::int64_t first = report_.path_before->plan_number;
  if (report_.path_before->status == "OK") {
    report_.replanned = live_->wait(kReplan, [&] {
      const Path* latest = live_->path_for(active_path_);
      return latest != nullptr && latest->plan_number > first;
    });
  }
  auto path = plan(false);
  if (!path) return tl::unexpected(path.error());
  took("path_after", since);
  say("after the edit: " + to_words(*path));
  report_.path_after = std::move(*path);
  return {};
}

DemoRun::Step DemoRun::collect() {
  if (const Step settled = settle(); !settled) return settled;
  const MapRequest save{live_->new_id(), MapRequest::Op::kSave, "demo", "bt", false, ""};
  const auto saved = live_->ask("in/map_request", encode(save, live_->bus().now()), save.id);
  if (!saved) return tl::unexpected(saved.error());
  const auto synced = [this] {
    return copies_->conflicts.synced() &&
           std::ranges::all_of(copies_->agents, [](const auto& c) { return c.second->synced(); });
  };
  report_.complete = live_->wait(kSync, synced);
  if (!report_.complete) say("not all streams arrived whole");
  if (auto written = save_map(options_.out / "map.bt", copies_->map.map(), scene_.resolution); !written) {
    return fail(written.error());
  }
  say("saved the map");
  return {};
}

void DemoRun::score_map(const BrickMap& before_edit) {
  if (!scene_.world) return;
  say("scoring against the true warehouse");
  const Truth truth = make_truth(*scene_.world, scene_.resolution);
  const DemoAgent& robot = scene_.agents.front();
  const Layer layer{&copies_->agents.at(robot.id)->map(), robot.T_map_agent, robot.weight};
  const MergedMap alone = compose(std::span(&layer, 1), {}, live_->site().merge.policy, scene_.resolution, threads());
  report_.robot = score(alone.values, truth);
  report_.merged = score(before_edit, truth);
  if (!scene_.edit.empty()) report_.edited = score(copies_->map.map(), truth);
}

DemoRun::Step DemoRun::tell() {
  report_.resolution = scene_.resolution;
  report_.cut = scene_.zmax + 0.5;
  report_.sources = options_.maps;
  report_.map = &copies_->map.map();
  report_.conflicts = &copies_->conflicts.map();
  for (const DemoAgent& agent : scene_.agents) {
    const AgentState* state = watch_->state_of(agent.id);
    if (state == nullptr) return fail(Exit::kIncomplete, "INCOMPLETE", "merge no longer lists " + agent.id);
    report_.agents.push_back({*state, &copies_->agents.at(agent.id)->map(), watch_->bytes_sent(agent),
                              agent.file ? std::nullopt : std::optional(agent.mapping_seconds)});
  }
  report_.edit = scene_.edit;
  report_.author = scene_.author;
  report_.start = scene_.start;
  report_.goal = scene_.goal;
  score_map(before_edit_);
  report_.seconds["total"] = now();
  if (auto written = write_report(report_, options_.out); !written) return fail(written.error());
  if (common_.json) common_.print(to_json(report_), "");
  say("report: " + (options_.out / "report.json").string() + ", picture: " + (options_.out / "overview.png").string());
  return {};
}

void DemoRun::show() {
  const std::string page = fs::absolute(options_.out / "index.html");
  say("page: file://" + page);
  if (std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr) {
    std::string program = "xdg-open", argument = page;
    char* arguments[] = {program.data(), argument.data(), nullptr};
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);  // the browser outlives us
    pid_t browser = 0;
    const bool opened = posix_spawnp(&browser, program.c_str(), nullptr, &attributes, arguments, environ) == 0;
    posix_spawnattr_destroy(&attributes);
    if (!opened) say("xdg-open is not installed: open the page yourself");
  }
  if (isatty(STDIN_FILENO) == 0) return;
  say("the stack goes on until Ctrl-C; try: ./run concord status, ./run spy");
  while (!end_requested()) live_->wait(0.5, end_requested);
}

DemoRun::Step DemoRun::check(const std::string& what) const {
  if (end_requested()) return fail(Exit::kIncomplete, "INTERRUPTED", "interrupted while waiting for " + what);
  if (const auto name = supervisor_.unusable()) {
    return fail(Exit::kUnusable, "CONFIGURATION",
                *name + " cannot use its configuration; see " + (options_.out / "output").string());
  }
  return {};
}

DemoRun::Step DemoRun::wait_for(const std::string& what, double seconds, const std::function<bool()>& done) {
  live_->wait(seconds, [&] { return end_requested() || supervisor_.unusable() || done(); });
  if (const Step fine = check(what); !fine) return fine;
  if (done()) return {};
  return fail(Exit::kNoAnswer, "NO_ANSWER",
              "waited in vain for " + what + "; see " + (options_.out / "output").string());
}

double DemoRun::now() const { return std::chrono::duration<double>(Supervisor::Clock::now() - began_).count(); }

void DemoRun::say(const std::string& line) const { std::fprintf(stderr, "[%5.1f s] %s\n", now(), line.c_str()); }

}  // namespace concord
