#include "session/hub.hpp"

#include <algorithm>
#include <utility>

#include "core/text.hpp"

namespace concord::hmd {
namespace {

constexpr std::int64_t kSweep = 10'000'000;

SharedText share(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

Refusal refusal(Code code, const std::string& message) { return {code, cut_to(message, 400), may_retry(code)}; }

/// What a request takes of those that a client may make: these walk over much of the map.
double cost_of(const RequestBody& body) {
  const bool walks = std::holds_alternative<GridRequest>(body) || std::holds_alternative<SceneGetRequest>(body) ||
                     std::holds_alternative<SaveRequest>(body) || std::holds_alternative<MinimapRequest>(body);
  return walks ? 10 : 1;
}

/// The name and the role of a request that is a binary frame.
const RequestInfo* upload_info(FrameKind kind) {
  const char* name = kind == FrameKind::kMesh     ? UploadMeshAnswer::kName
                     : kind == FrameKind::kVoxels ? UploadVoxelsAnswer::kName
                                                  : "";
  const auto& infos = request_infos();
  const auto it = std::find_if(infos.begin(), infos.end(),
                               [&](const RequestInfo& info) { return std::string_view(info.name) == name; });
  return it != infos.end() ? &*it : nullptr;
}

}  // namespace

Hub::Hub(Gate& gate, Config config, Handlers handlers)
    : gate_(gate), config_(std::move(config)), handlers_(std::move(handlers)) {}

Result<Hub::Connection> Hub::open(const Peer& peer, std::int64_t now) {
  now_ = now;
  const auto same = static_cast<std::size_t>(std::count_if(
      links_.begin(), links_.end(), [&](const auto& entry) { return entry.second.peer.address == peer.address; }));
  if (!has_place(peer)) return refuse_busy("there are as many clients as may be");
  if (!peer.local && too_many_wait(peer)) return refuse_busy("too many connections have not said hello yet");
  if (!peer.local && same >= config_.max_clients_per_address)
    return refuse_busy("there are as many clients from this address as may be");
  const SessionLimits& limits = config_.limits;
  Link link{.peer = peer,
            .opened = now,
            .session = {},
            .first = {},
            .asked = {},
            .asked_bytes = 0,
            .last = nullptr,
            .closing = {},
            .refusals = TokenBucket(limits.refusals_per_second, limits.burst_refusals)};
  links_.emplace(++last_connection_, std::move(link));
  return last_connection_;
}

bool Hub::has_place(const Peer& peer) const {
  const std::size_t kept = peer.local ? 0 : std::min<std::size_t>(kLocalPlaces, config_.max_clients / 4);
  return greeted() < config_.max_clients - kept;
}

std::size_t Hub::greeted() const {
  return static_cast<std::size_t>(
      std::count_if(links_.begin(), links_.end(), [](const auto& entry) { return entry.second.session.has_value(); }));
}

bool Hub::too_many_wait(const Peer& peer) const {
  const std::string network = network_of(peer.address);
  std::size_t all = 0, same = 0;
  for (const auto& [connection, link] : links_) {
    if (link.session || link.peer.local) continue;
    ++all;
    if (network_of(link.peer.address) == network) ++same;
  }
  return all >= kMaxUngreeted || same >= kMaxUngreetedPerNetwork;
}

tl::unexpected<Error> Hub::refuse_busy(const char* why) { return concord::refuse(concord::Code::kBusy, why); }

void Hub::text(Connection connection, std::string_view text, std::int64_t now) {
  now_ = now;
  const auto it = links_.find(connection);
  if (it == links_.end() || it->second.closing) return;
  Link& link = it->second;
  Session* session = link.session ? find(*link.session) : nullptr;
  if (session != nullptr && !session->texts.take(static_cast<double>(text.size()), now))
    return close(connection, link, 1008, Code::kRate, "more bytes of text than allowed");
  auto read = read_client_text(text);
  if (!read) {
    const BadText& bad = read.error();
    if (session == nullptr) return close(connection, link, 1002, Code::kBadMessage, bad.message);
    const Code code = bad.is_name ? Code::kBadName : Code::kBadMessage;
    if (bad.id) return refuse_now(connection, link, *session, *bad.id, "?", code, bad.message, now);
    audit(*session, "?", 0, text_of(code));
    count_refusal(connection, link, now);
    return tell(*session, "bad", event_text(BadEvent{cut_to(bad.message, 400)}));
  }
  const auto* request = std::get_if<ClientRequest>(&*read);
  if (session == nullptr) {
    if (request == nullptr || !std::holds_alternative<HelloRequest>(request->body)) {
      return close(connection, link, 1002, Code::kBadMessage, "the first frame must be the request hello");
    }
    return greet(connection, link, *request, now);
  }
  if (request != nullptr) return take_request(connection, *session, *request, now);
  if (!session->notices.take(1, now)) {
    audit(*session, "notice", 0, text_of(Code::kRate));
    return count_refusal(connection, link, now);
  }
  take_notice(*session, std::get<NoticeBody>(*read));
}

bool Hub::is_new(Connection connection, Link& link, Session& session, std::int64_t id, const std::string& name,
                 std::int64_t now) {
  if (const RecentTexts::Said* said = session.answered.find(id)) {
    for (const FramePointer& frame : said->frames) enqueue(connection, link, frame);
    session.outbox.lossless(said->text);
    ready(session);
    return false;
  }
  if (session.pending.contains(id)) return false;  // its answer is on the way
  if (id > session.highest_id) return true;
  refuse_now(connection, link, session, id, name, Code::kBadRequest, "ids of requests count up", now);
  return false;
}

void Hub::take_request(Connection connection, Session& session, const ClientRequest& request, std::int64_t now) {
  Link& link = links_.at(connection);
  const RequestInfo& info = info_of(request.body);
  const auto no = [&](Code code, const std::string& message) {
    refuse_now(connection, link, session, request.id, info.name, code, message, now);
  };
  // First of all: what is asked again is answered again, and costs as much.
  if (!session.requests.take(cost_of(request.body), now))
    return no(Code::kRate, "more requests than allowed; see limits");
  if (!is_new(connection, link, session, request.id, info.name, now)) return;
  session.highest_id = request.id;
  if (std::holds_alternative<HelloRequest>(request.body)) return no(Code::kBadRequest, "hello was said already");
  if (!may(session.identity.role, info.role)) {
    return no(Code::kDenied,
              "needs the role " + std::string(text_of(info.role)) + ", and yours is " + text_of(session.identity.role));
  }
  if (session.pending.size() >= kMaxPending) return no(Code::kBusy, "64 requests wait for their answers");
  session.pending.emplace(request.id, Session::Pending{info.name, {}});
  const Ask ask{session.person, request.id};
  if (const auto* clock = std::get_if<ClockRequest>(&request.body))
    return answer(ask, ClockAnswer{clock->t0, now, now});
  handlers_.on_request(ask, request.body);
}

void Hub::binary(Connection connection, ByteSpan bytes, std::int64_t now) {
  now_ = now;
  const auto it = links_.find(connection);
  if (it == links_.end() || it->second.closing) return;
  Link& link = it->second;
  Session* session = link.session ? find(*link.session) : nullptr;
  if (session == nullptr)
    return close(connection, link, 1002, Code::kBadMessage, "the first frame must be the request hello");
  auto frame = read_packed(bytes);
  if (!frame) {
    // The id is where it is, whatever else is wrong.
    ByteSpan at = bytes.size() >= 8 ? bytes.subspan(4) : ByteSpan();
    const std::int64_t id = read_le<std::uint32_t>(at).value_or(0);
    const Code code = frame.error().code == concord::Code::kTooLarge ? Code::kTooLarge : Code::kBadMessage;
    return refuse_now(connection, link, *session, id, "frame", code, frame.error().message, now);
  }
  const std::int64_t id = frame->head.stream;
  const RequestInfo* info = upload_info(frame->head.kind);
  const auto no = [&](Code code, const std::string& message) {
    refuse_now(connection, link, *session, id, info != nullptr ? info->name : "frame", code, message, now);
  };
  if (info == nullptr || id == 0)
    return no(Code::kBadMessage, "clients send frames of kind 65 and 66, under a request's id");
  if (!session->requests.take(1, now)) return no(Code::kRate, "more requests than allowed; see limits");
  if (!is_new(connection, link, *session, id, info->name, now)) return;
  if (!session->uploads.take(static_cast<double>(bytes.size()), now))
    return no(Code::kRate, "more bytes than allowed; see limits");
  if (!session->looks.take(1, now)) return no(Code::kRate, "at most 4 looks a second; 20 at once");
  session->highest_id = id;
  if (!may(session->identity.role, info->role)) return no(Code::kDenied, "who only looks cannot map");
  if (session->pending.size() >= kMaxPending) return no(Code::kBusy, "64 requests wait for their answers");
  session->pending.emplace(id, Session::Pending{info->name, {}});
  handlers_.on_upload({session->person, id}, std::move(*frame));
}

void Hub::take_notice(Session& session, const NoticeBody& notice) {
  if (const auto* credit = std::get_if<CreditNotice>(&notice)) {
    session.outbox.credit(credit->bytes);
    return ready(session);
  }
  const auto& tracking = std::get<TrackingNotice>(notice);
  session.tracking_lost = tracking.state == Tracking::kLost;
  if (!session.agent.empty() && tracking.frame_id) session.frame_id = *tracking.frame_id;
  session.T_own_head.reset();
  if (tracking.T_own_head) {
    const auto& [p, q] = *tracking.T_own_head;
    if (const auto T = make_transform({p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]})) session.T_own_head = *T;
  }
  session.pointer.reset();
  if (tracking.pointer)
    session.pointer = Eigen::Vector3d((*tracking.pointer)[0], (*tracking.pointer)[1], (*tracking.pointer)[2]);
  handlers_.on_tracking(session);
}

void Hub::refuse_now(Connection connection, Link& link, Session& session, std::int64_t id, const std::string& name,
                     Code code, const std::string& message, std::int64_t now) {
  session.outbox.lossless(share(error_text(id, refusal(code, message))));
  audit(session, name, id, text_of(code));
  ready(session);
  count_refusal(connection, link, now);
}

void Hub::count_refusal(Connection connection, Link& link, std::int64_t now) {
  if (!link.refusals.take(1, now)) close(connection, link, 1008, Code::kRate, "too many refused messages");
}

void Hub::close(Connection connection, Link& link, std::uint16_t code, Code why, const std::string& message) {
  if (link.closing) return;
  const Session* session = link.session ? find(*link.session) : nullptr;
  const std::string who = session != nullptr ? "by=" + Json(session->identity.name).dump() + " " : "";
  if (code != 1001)
    handlers_.audit("refused " + who + "from=" + link.peer.address +
                    " request=connection close=" + std::to_string(code) + " outcome=" + text_of(why));
  link.closing = Closing{code, cut_to(message, 100)};
  link.last = share(event_text(ByeEvent{why, cut_to(message, 400)}));
  ready_.insert(connection);
}

void Hub::closed(Connection connection, std::int64_t now) {
  now_ = now;
  const auto it = links_.find(connection);
  if (it == links_.end()) return;
  if (it->second.session) {
    Session* session = find(*it->second.session);
    if (session != nullptr) park(*session, now);
  }
  links_.erase(it);
  ready_.erase(connection);
}

void Hub::park(Session& session, std::int64_t now) {
  session.connection.reset();
  session.parked_at = now;
  session.outbox = Outbox();
  handlers_.on_end(session);
}

void Hub::tick(std::int64_t now) {
  now_ = now;
  for (auto& [connection, link] : links_) {
    if (!link.session && !link.closing && now - link.opened > kHelloWithin) {
      close(connection, link, 1008, Code::kTimeout, "no hello within 5 s");
    }
    const Session* session = link.session ? find(*link.session) : nullptr;
    if (session != nullptr && session->outbox.overflowed()) {
      close(connection, link, 1013, Code::kTooLarge, "answers were not taken in time");
    }
  }
  std::vector<std::pair<std::int64_t, std::int64_t>> parked;  // since, number
  for (const auto& [number, session] : sessions_) {
    if (!session.connection) parked.emplace_back(session.parked_at, number);
  }
  std::sort(parked.rbegin(), parked.rend());
  std::map<std::string, int> of_network, of_identity;
  int in_all = 0;
  for (const auto& [since, number] : parked) {  // the latest first
    const Session& session = sessions_.at(number);
    const bool one_too_many = ++of_network[network_of(session.address)] > kMaxParkedOfOne ||
                              (session.by_token && ++of_identity[session.identity.name] > kMaxParkedOfOne) ||
                              ++in_all > kMaxParked;
    if (one_too_many || now - since > kParked) sessions_.erase(number);
  }
  tell_behind(now);
  if (now - last_sweep_ > kSweep) {
    last_sweep_ = now;
    sweep();
  }
}

void Hub::keep_only(const std::function<bool(const Identity&)>& holds) {
  for (auto it = sessions_.begin(); it != sessions_.end();) {
    Session& session = it->second;
    const bool good = !session.by_token || holds(session.identity);
    if (!good && session.connection) {
      close(*session.connection, links_.at(*session.connection), 1008, Code::kBadToken, "this token was taken away");
      session.secret = gate_.new_secret();  // nobody takes it up again
    }
    it = good || session.connection ? std::next(it) : sessions_.erase(it);
  }
}

void Hub::end() {
  for (auto& [connection, link] : links_) close(connection, link, 1001, Code::kUnavailable, "the server ends");
}

std::vector<Hub::Connection> Hub::take_ready() {
  std::vector<Connection> ready(ready_.begin(), ready_.end());
  ready_.clear();
  return ready;
}

std::optional<Hub::Closing> Hub::closing(Connection connection) const {
  const auto it = links_.find(connection);
  if (it == links_.end()) return Closing{};
  return it->second.closing;
}

void Hub::audit(const Session& session, const std::string& request, std::int64_t id, const std::string& outcome) const {
  handlers_.audit((outcome == "OK" ? "done by=" : "refused by=") + Json(session.identity.name).dump() +
                  " person=" + std::to_string(session.person) + " from=" + session.address + " request=" + request +
                  " id=" + std::to_string(id) + " outcome=" + outcome);
}

}  // namespace concord::hmd
