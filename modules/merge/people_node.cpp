#include "merge/people_node.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "bus/messages_map.hpp"

namespace concord {
namespace {

constexpr std::int64_t kExpirePeriod = 100'000;
constexpr std::int64_t kSayPeriod = 1'000'000;
const std::string kLeaseChannel = "in/lease";

/// Of all that it asks, its time left out where that is only when it was asked.
template <class Request>
std::uint64_t content_without_time(Request& request) {
  if constexpr (requires { encode(request); }) {
    if constexpr (!std::is_same_v<Request, LocaliseRequest>) request.utime = 0;
    return content_of(encode(request));
  } else {
    return content_of(request);
  }
}

/// What the answer says, to a person.
std::string message_of(const Operation& made) {
  switch (made.kind) {
    case Operation::Kind::kAdd:
    case Operation::Kind::kDelete: return "pinned";
    case Operation::Kind::kMove: return "moved";
    case Operation::Kind::kUndo: return made.subject + " is undone";
    case Operation::Kind::kRedo: return made.subject + " is done again";
    case Operation::Kind::kZoneAdd: return "zone " + made.subject + " is there";
    case Operation::Kind::kZoneChange: return "zone " + made.subject + " is changed";
    case Operation::Kind::kZoneDelete: return "zone " + made.subject + " is gone";
    case Operation::Kind::kTransform: return made.subject + " is placed";
    case Operation::Kind::kWeight: break;
  }
  return made.subject + " has its weight";
}

/// Voxels that an edit pins; one of anything else.

}  // namespace

PeopleNode::PeopleNode(const NodeContext& context, MergeStore& store, People& people, MapStreams& map,
                       AgentsNode& agents)
    : context_(context),
      store_(store),
      people_(people),
      map_(map),
      agents_(agents),
      replies_(context),
      answers_(context.bus),
      zone_list_(context.bus, context.counters, "out/zones", context.site.stream.bytes_per_second),
      lease_list_(context.bus, context.counters, "out/leases", context.site.stream.bytes_per_second) {
  hear<EditRequest>("in/edit", [this](const EditRequest& request) { return check(request); });
  hear<UndoRequest>("in/undo",
                    [this](const UndoRequest& request) { return people_.check(request, context_.bus.now()); });
  hear<ZoneRequest>("in/zone", [this](const ZoneRequest& request) { return check(request); });
  hear<TransformRequest>("in/transform", [this](const TransformRequest& request) { return agents_.check(request); });
  hear<LocaliseRequest>("in/localise", [this](const LocaliseRequest& request) { return agents_.check(request); });
  hear<WeightRequest>("in/weight", [this](const WeightRequest& request) { return agents_.check(request); });
  listen<LeaseRequest>(context_.bus, context_.counters, context_.process, kLeaseChannel,
                       [this](const std::string&, const LeaseRequest& request) { on_lease(request); });
  say_zones();
  say_leases();
  context_.bus.every(kExpirePeriod, [this] { expire_leases(); });
  context_.bus.every(kSayPeriod, [this] { say_edits(); });
}

template <class Request, class Check>
void PeopleNode::hear(const std::string& channel, Check check) {
  listen<Request>(context_.bus, context_.counters, context_.process, channel,
                  [this, check](const std::string& on, Request request) {
                    const std::int64_t asked = request.utime;
                    const std::uint64_t content = content_without_time(request);
                    if (repeat(on, request.id, content)) return;
                    if (answers_.repeat(request.id, context_.process, content, asked)) return;
                    const auto deny = [&](const Error& why) {
                      answers_.give(replies_.denied(on, request.id, why), content, asked);
                    };
                    auto what = check(request);
                    if (!what) return deny(what.error());
                    const Correction correction{people_.revision() + 1, request.id, request.author,
                                                context_.bus.now(),     content,    std::move(*what)};
                    if (const auto done = commit({&correction, 1}); !done) return deny(done.error());
                    const Operation& made = people_.find(request.id)->operation;
                    replies_.grant(made.id, made.revision, count_of(made), message_of(made));
                  });
}

/// Voxels that an edit pins, be it that it was undone or done again; of anything else one.
std::int64_t PeopleNode::count_of(const Operation& made) const {
  const bool is_turned = made.kind == Operation::Kind::kUndo || made.kind == Operation::Kind::kRedo;
  const People::Made* subject = is_turned ? people_.find(made.subject) : nullptr;
  return std::max<std::int64_t>(subject != nullptr ? subject->operation.count : made.count, 1);
}

bool PeopleNode::repeat(const std::string& channel, const std::string& id, std::uint64_t content) {
  const People::Made* before = people_.find(id);
  if (before == nullptr) return false;
  const Operation& made = before->operation;
  if (before->content == 0 || before->content == content) {
    replies_.grant(id, made.revision, count_of(made), message_of(made) + " since it was asked before");
  } else {
    replies_.deny(channel, id, {Code::kExists, "another request had this id; ids must be unique"});
  }
  return true;
}

Result<Correction::Edit> PeopleNode::check(const EditRequest& request) {
  const auto T_map_frame = agents_.T_map_frame(request.frame);
  if (!T_map_frame) return tl::unexpected(T_map_frame.error());
  if (request.op == EditRequest::Op::kMove) {
    if (!map_.begun()) return refuse(Code::kBusy, "the map is not whole again after a restart; ask again in a second");
    map_.refold_and_send();  // what is occupied now, not 20 ms ago
  }
  return people_.check(request, *T_map_frame, map_.layers().map(), context_.bus.now());
}

Result<Correction::ZoneChange> PeopleNode::check(const ZoneRequest& request) {
  if (request.op == ZoneRequest::Op::kDelete) return people_.check(request, Transform::Identity(), context_.bus.now());
  const auto T_map_frame = agents_.T_map_frame(request.frame);
  if (!T_map_frame) return tl::unexpected(T_map_frame.error());
  return people_.check(request, *T_map_frame, context_.bus.now());
}

Result<void> PeopleNode::commit(std::span<const Correction> corrections) {
  if (const auto stored = store_.put(corrections); !stored) return stored;
  follow(corrections);
  map_.refold_and_send();
  say_edits();
  return {};
}

/// Makes it so, once it is stored: all of it first, so that a layer that was placed often is put into the map once.
void PeopleNode::follow(std::span<const Correction> corrections) {
  BrickSet touched;
  std::set<std::string> agents;
  bool has_zones = false;
  for (const Correction& correction : corrections) {
    people_.apply(correction, touched);
    if (const auto* placement = std::get_if<Correction::Placement>(&correction.what)) agents.insert(placement->agent);
    if (const auto* undo = std::get_if<Correction::Undo>(&correction.what)) {
      const People::Made* undone = people_.find(undo->edit_id);
      if (undone != nullptr && undone->operation.kind == Operation::Kind::kTransform) {
        agents.insert(undone->operation.subject);
      }
    }
    if (const auto* weight = std::get_if<Correction::Weight>(&correction.what)) agents.insert(weight->agent);
    has_zones = has_zones || std::holds_alternative<Correction::ZoneChange>(correction.what);
  }
  map_.layers().mark(touched);
  for (const std::string& agent : agents) agents_.follow(agent);
  if (has_zones) say_zones();
}

void PeopleNode::on_lease(const LeaseRequest& request) {
  const std::uint64_t content = content_of(encode(request));
  if (answers_.repeat(request.id, context_.process, content)) return;
  const auto done = request.hold ? hold(request) : people_.leases().free(request, context_.bus.now());
  if (!done) return answers_.give(replies_.denied(kLeaseChannel, request.id, done.error()), content);
  if (*done) say_leases();
  const char* words = request.hold ? "held for 10 s" : "freed";
  answers_.give(replies_.granted(request.id, people_.revision(), *done ? 1 : 0, words), content);
}

/// Returns true: there is one.
Result<bool> PeopleNode::hold(const LeaseRequest& request) {
  const auto T_map_frame = agents_.T_map_frame(request.frame);
  if (!T_map_frame) return tl::unexpected(T_map_frame.error());
  auto lease = people_.leases().check(request, *T_map_frame, context_.bus.now());
  if (!lease) return tl::unexpected(lease.error());
  people_.leases().hold(std::move(*lease));
  return true;
}

void PeopleNode::expire_leases() {
  if (people_.leases().expire(context_.bus.now())) say_leases();
}

void PeopleNode::say_zones() {
  std::vector<Zone> zones;
  for (const auto& [name, zone] : people_.zones()) zones.push_back(zone);
  zone_list_.set(zones);
}

/// @pre what was made has been folded into the map, as it is with each commit.
void PeopleNode::say_edits() {
  if (!map_.begun()) return;
  context_.bus.publish("out/map_edits",
                       encode(MapEdits{context_.bus.now(), map_.boot_id(), people_.revision(), map_.revision()}));
}

void PeopleNode::say_leases() { lease_list_.set(people_.leases().list()); }

}  // namespace concord
