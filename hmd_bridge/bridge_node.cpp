#include "bridge_node.hpp"

#include <spdlog/spdlog.h>

#include "bridge/requests.hpp"

namespace concord::hmd {
namespace {

constexpr std::int64_t kTick = 500'000;  // microseconds
constexpr std::int32_t kMaxParts = 100'000;

/// Parts of answers to our own requests; others' are passed over.
template <class Part>
void gather(Desk& desk, const std::string& channel, std::map<std::string, std::map<std::int32_t, Part>>& into) {
  const NodeContext& context = desk.context;
  listen<Part>(context.bus, context.counters, context.process, channel, [&desk, &into](const std::string&, Part part) {
    const auto it = into.find(part.id);
    if (it == into.end() || part.parts > kMaxParts) return;
    const std::string id = part.id;
    // Asked again, the answer may have changed: what was heard before belongs to another.
    if (!it->second.empty() && it->second.begin()->second.parts != part.parts) it->second.clear();
    const std::int32_t number = part.part;
    it->second.insert_or_assign(number, std::move(part));
    desk.asker.arrived(id);
  });
}

}  // namespace

Hub::Config hub_config(const Site& site) {
  Hub::Config config;
  config.resolution = site.resolution;
  config.max_clients = static_cast<std::size_t>(site.bridge.max_clients);
  config.local_role = site.bridge.local_role == "view"    ? Role::kView
                      : site.bridge.local_role == "robot" ? Role::kRobot
                                                          : Role::kEdit;
  return config;
}

BridgeNode::BridgeNode(const NodeContext& context, Gate& gate, const Hub::Config& config, std::launch how,
                       std::string models, const MapLimits& limits)
    : context_(context),
      hub_(gate, config, handlers()),
      world_(context, hub_),
      asker_(context),
      desk_(context, hub_, world_, asker_, std::move(models)),
      own_maps_(desk_, how, limits) {
  world_.on_path = [this](const concord::Path& path) { on_path(path); };
  hear_parts();
  hear_alignments(desk_);
  context_.bus.every(kTick, [this] {
    hub_.tick(context_.bus.now());
    tell_silent();
    context_.counters.set("clients", static_cast<std::int64_t>(hub_.connected()));
    std::erase_if(desk_.placed, [this](const auto& entry) { return hub_.find(entry.first.first) == nullptr; });
  });
}

Hub::Handlers BridgeNode::handlers() {
  Hub::Handlers handlers;
  handlers.on_request = [this](const Ask& ask, const RequestBody& body) {
    std::visit(
        [&](const auto& request) {
          using Request = std::decay_t<decltype(request)>;
          if constexpr (std::is_same_v<Request, SendMapRequest>) {
            own_maps_.send_map(ask, request);
          } else if constexpr (!std::is_same_v<Request, HelloRequest> && !std::is_same_v<Request, ClockRequest>) {
            work_on(desk_, ask, request);
          }
        },
        body);
  };
  handlers.on_upload = [this](const Ask& ask, PackedFrame frame) { own_maps_.upload(ask, std::move(frame)); };
  handlers.on_tracking = [this](Session& session) { own_maps_.tracking(session); };
  handlers.on_begin = [this](Session& session, bool resumed) {
    world_.welcome(session.person);
    own_maps_.begin(session, resumed);
  };
  handlers.on_end = [](const Session&) {};
  handlers.not_for_clients = [this](const std::string& agent, Role role) {
    return own_maps_.not_for_clients(agent, role);
  };
  handlers.audit = [this](const std::string& line) {
    context_.counters.add(line.starts_with("refused") ? "refused.client" : "requests.changing");
    spdlog::info("audit: {}", line);
  };
  return handlers;
}

void BridgeNode::on_path(const concord::Path& path) {
  if (desk_.watched.contains(path.id)) {
    desk_.paths.insert_or_assign(path.id, path);
    asker_.arrived(path.id);
  }
  if (!path.active) return tell_ended(path);
  for (auto& [number, session] : hub_.sessions()) {
    const auto followed = session.path_frames.find(path.robot);
    if (!session.connection || followed == session.path_frames.end()) continue;
    const auto where = desk_.place(session, followed->second);
    if (!where) continue;
    const Session::ToldPath told{path.id, path.plan_number, path.message, where->T_map_frame.matrix()};
    const auto last = session.told_paths.find(path.robot);
    if (last != session.told_paths.end() && last->second == told) continue;
    const auto shown = desk_.show(session, path, followed->second);
    if (!shown) continue;
    session.told_paths.insert_or_assign(path.robot, told);
    hub_.tell(session, "path/" + path.robot, event_text(PathEvent{path.robot, *shown}));
  }
}

/// The answer to a question is no news to anybody else; the end of what a client was told last is.
void BridgeNode::tell_ended(const concord::Path& path) {
  for (auto& [number, session] : hub_.sessions()) {
    const auto told = session.told_paths.find(path.robot);
    if (told != session.told_paths.end() && told->second.id == path.id) tell_no_path(session, path.robot);
  }
}

/// A planner that is silent keeps no path up to date.
void BridgeNode::tell_silent() {
  for (auto& [number, session] : hub_.sessions()) {
    std::vector<std::string> silent;
    for (const auto& [robot, told] : session.told_paths) {
      if (world_.active_path(robot) == nullptr) silent.push_back(robot);
    }
    for (const std::string& robot : silent) tell_no_path(session, robot);
  }
}

void BridgeNode::tell_no_path(Session& session, const std::string& robot) {
  session.told_paths.erase(robot);
  const auto followed = session.path_frames.find(robot);
  if (!session.connection || followed == session.path_frames.end()) return;
  if (const auto shown = desk_.show(session, Desk::no_path(robot), followed->second)) {
    hub_.tell(session, "path/" + robot, event_text(PathEvent{robot, *shown}));
  }
}

void BridgeNode::hear_parts() {
  gather(desk_, "out/history", desk_.history);
  gather(desk_, "out/conflict_list", desk_.conflicts);
  gather(desk_, "out/downsampled", desk_.points);
  gather(desk_, "out/label_list", desk_.labels);
  listen<MapList>(context_.bus, context_.counters, context_.process, "out/map_list",
                  [this](const std::string&, MapList list) {
                    if (!desk_.watched.contains(list.id)) return;
                    const std::string id = list.id;
                    desk_.maps.insert_or_assign(id, std::move(list));
                    asker_.arrived(id);
                  });
}

}  // namespace concord::hmd
