// The way in: hello, and sessions that are taken up again.

#include "session/hub.hpp"

#include <algorithm>
#include <utility>

#include "core/text.hpp"

namespace concord::hmd {
namespace {

SharedText share(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

Refusal refusal(Code code, const std::string& message) { return {code, cut_to(message, 400), may_retry(code)}; }

}  // namespace

void Hub::greet(Connection connection, Link& link, const ClientRequest& request, std::int64_t now) {
  const auto& hello = std::get<HelloRequest>(request.body);
  const auto no = [&](Code code, const char* message) {
    handlers_.audit("refused from=" + link.peer.address + " request=hello outcome=" + text_of(code));
    link.first.push_back(share(error_text(request.id, refusal(code, message))));
    close(connection, link, 1008, code, message);
  };
  if (hello.version != kProtocol) return no(Code::kVersion, "this server speaks hmd.v1; load the page again");
  Identity identity{hello.name.value_or("local"), config_.local_role};
  if (hello.ticket) {
    const std::optional<Identity> redeemed = gate_.redeem(*hello.ticket, now);
    if (!redeemed) return no(Code::kBadToken, "the ticket was used, is over 10 s old, or never was; ask for another");
    identity = *redeemed;
  } else if (!link.peer.local) {
    return no(Code::kBadToken, "from another machine a ticket is needed: POST /api/ticket with a token");
  }
  if (hello.agent.has_value() != hello.frame_id.has_value())
    return no(Code::kBadFrame, "agent and frame_id are given together, or neither");
  if (hello.agent && !may(identity.role, Role::kEdit)) return no(Code::kDenied, "who only looks cannot be an agent");
  const bool taken = hello.agent && std::any_of(sessions_.begin(), sessions_.end(), [&](const auto& entry) {
                       const Session& other = entry.second;
                       return other.connection && other.agent == *hello.agent && other.identity.name != identity.name;
                     });
  if (taken) return no(Code::kDenied, "somebody else is this agent now; choose another name for it");
  const auto why = hello.agent ? handlers_.not_for_clients(*hello.agent, identity.role) : std::nullopt;
  if (why) return no(Code::kDenied, why->c_str());
  if (Session* old = resumable(hello, identity)) return begin(connection, link, *old, hello, request.id, true, now);
  if (!has_place(link.peer)) return no(Code::kBusy, "there are as many clients as may be");
  ++last_session_;
  auto [it, fresh] = sessions_.try_emplace(last_session_, last_session_, gate_.new_secret(), identity, config_.limits);
  it->second.by_token = hello.ticket.has_value();
  begin(connection, link, it->second, hello, request.id, false, now);
}

Session* Hub::resumable(const HelloRequest& hello, const Identity& identity) {
  if (!hello.resume) return nullptr;
  for (auto& [number, session] : sessions_) {
    if (session.secret != hello.resume->session || session.identity.name != identity.name) continue;
    if (session.identity.role != identity.role || session.agent != hello.agent.value_or("")) return nullptr;
    return &session;
  }
  return nullptr;
}

/// What a client has that comes back with this revision, of the last complete that it heard.
std::optional<Session::Kept> Hub::kept_of(const Session& session, const ShownLayer& map, std::int64_t revision) {
  if (!session.whole || revision < session.whole->first || revision > session.whole->last) return std::nullopt;
  // What was emptied after that may be forgotten here: sent on a connection that was dying, it never arrived.
  if (map.store.dropped() > revision) return std::nullopt;
  return Session::Kept{session.whole->region, revision};
}

void Hub::begin(Connection connection, Link& link, Session& session, const HelloRequest& hello, std::int64_t id,
                bool resumed, std::int64_t now) {
  if (session.connection) {  // it lost that one and we have not noticed yet
    const auto old = links_.find(*session.connection);
    if (old != links_.end()) {
      old->second.session.reset();
      old->second.closing = Closing{1000, "taken up by another connection"};
      ready_.insert(old->first);
    }
    park(session, now);
  }
  session.outbox = Outbox();
  const ShownLayer* map = layers_.find(kMapStream);
  const bool has_blocks = resumed && map != nullptr && hello.resume->epoch == map->epoch;
  session.kept = has_blocks ? kept_of(session, *map, hello.resume->revision) : std::nullopt;
  session.whole.reset();
  session.views.clear();
  session.told_complete.clear();
  session.told_skipped = 0;
  session.path_frames.clear();
  session.told_paths.clear();
  session.connection = connection;
  session.address = link.peer.address;
  session.device = hello.device;
  session.agent = hello.agent.value_or("");
  session.frame_id = hello.frame_id.value_or("");
  session.tracking_lost = false;
  // What was asked before the connection was lost may come yet, under ids below this hello's.
  if (!resumed) session.highest_id = id;
  link.session = session.person;

  const SessionLimits& limits = config_.limits;
  const HelloAnswer answer{
      session.secret,
      session.person,
      session.identity.role,
      session.identity.name,
      resumed,
      config_.resolution,
      map != nullptr ? map->epoch : "",
      now,
      {static_cast<std::int64_t>(kMaxTextBytes), static_cast<std::int64_t>(kMaxBinaryBytes), limits.requests_per_second,
       limits.upload_bytes_per_second, static_cast<std::int64_t>(limits.burst_requests),
       static_cast<std::int64_t>(limits.burst_upload_bytes), 30.0}};
  session.outbox.lossless(share(answer_text(id, answer)));
  // It keeps its blocks, and we do not know which: it is to drop them.
  if (has_blocks && !session.kept) session.outbox.lossless(share(event_text(EpochEvent{kMapStream, map->epoch})));
  for (const auto& [key, text] : state_) session.outbox.newest(key, text);
  const std::string as = session.agent.empty() ? "" : " agent=" + session.agent;
  audit(session, (resumed ? "hello(resumed)" : "hello") + as, id, "OK");
  ready(session);
  handlers_.on_begin(session, resumed);
}

}  // namespace concord::hmd
