#include <algorithm>

#include "session/hub.hpp"

#include "core/text.hpp"

namespace concord::hmd {
namespace {

constexpr std::int64_t kBehind = 1'000'000;

SharedText share(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

}  // namespace

std::optional<Hub::Outgoing> Hub::next(Connection connection) {
  const auto it = links_.find(connection);
  if (it == links_.end()) return std::nullopt;
  Link& link = it->second;
  if (!link.first.empty()) {
    SharedText text = std::move(link.first.front());
    link.first.pop_front();
    return text;
  }
  Session* session = link.session ? find(*link.session) : nullptr;
  if (session != nullptr && session->outbox.overflowed() && !link.closing) {
    close(connection, link, 1013, Code::kTooLarge, "answers were not taken in time");
  }
  if (!link.asked.empty()) {
    FramePointer frame = std::move(link.asked.front());
    link.asked.pop_front();
    link.asked_bytes -= frame->size();
    return frame;
  }
  if (session != nullptr) {
    if (SharedText text = session->outbox.take()) return text;
    if (!link.closing) {
      if (auto block = next_block(*session)) return block;
      if (SharedText text = complete_event(*session)) return text;
    }
  }
  if (link.closing && link.last != nullptr) return std::exchange(link.last, nullptr);
  return std::nullopt;
}

/// The nearest block of all views that this client lacks, if its credit pays for it.
std::optional<Hub::Outgoing> Hub::next_block(Session& session) {
  ShownLayer* layer = nullptr;
  ClientView* view = nullptr;
  double least = 0;
  for (auto& [stream, candidate] : session.views) {
    const auto due = candidate.nearest();
    if (!due) continue;
    const double distance = distance_to(candidate.region(), due->key);
    if (view != nullptr && distance >= least) continue;
    least = distance;
    view = &candidate;
    layer = layers_.find(stream);
  }
  for (auto& [stream, candidate] : session.views) {
    if (!session.outbox.affords(kFrameHeader)) break;
    const std::vector<BlockKey> gone = candidate.take_forgotten();
    if (gone.empty()) continue;
    std::vector<BlockIndex> blocks;
    for (const BlockKey& key : gone) blocks.push_back(key.index);
    const FrameHead head{.kind = FrameKind::kForget,
                         .whole = false,
                         .level = gone.front().level,
                         .stream = stream,
                         .count = static_cast<std::uint32_t>(blocks.size()),
                         .revision = layers_.revision()};
    auto frame = std::make_shared<const Bytes>(make_frame(head, forget_payload(blocks)));
    session.outbox.spend(frame->size());
    return frame;
  }
  if (view == nullptr) return std::nullopt;
  const auto due = *view->nearest();
  FramePointer frame = layer->store.frame(due.key, due.since);
  if (!session.outbox.affords(frame->size())) return std::nullopt;
  session.outbox.spend(frame->size());
  view->sent(layer->store, due.key);
  return frame;
}

SharedText Hub::complete_event(Session& session) {
  for (auto& [stream, view] : session.views) {
    const ShownLayer& layer = *layers_.find(stream);
    // What has changed and was not told to views yet is lacking, too.
    if (!view.complete() || !layer.changed.empty()) continue;
    const Session::Told now{layer.revision, layer.map_revision, layer.synced};
    Session::Told& told = session.told_complete[stream];
    if (told == now) continue;
    told = now;
    if (stream == kMapStream) {
      if (!session.whole) session.whole = Session::Whole{view.region(), layer.revision, layer.revision};
      session.whole->last = layer.revision;
    }
    return share(event_text(CompleteEvent{stream, layer.epoch, layer.revision, layer.map_revision, layer.synced}));
  }
  return nullptr;
}

void Hub::ready(const Session& session) {
  if (session.connection) ready_.insert(*session.connection);
}

void Hub::answer_text_to(const Ask& ask, SharedText text, const char* outcome) {
  Session* session = find(ask.session);
  if (session == nullptr)
    return handlers_.audit("late person=" + std::to_string(ask.session) + " id=" + std::to_string(ask.id) +
                           " outcome=" + outcome);
  const auto it = session->pending.find(ask.id);
  if (it == session->pending.end()) return;
  const std::string name = it->second.name;
  session->answered.keep(ask.id, text, std::move(it->second.frames));
  session->pending.erase(it);
  if (session->connection) session->outbox.lossless(std::move(text));
  const auto& infos = request_infos();
  const auto info = std::find_if(infos.begin(), infos.end(), [&](const RequestInfo& i) { return i.name == name; });
  const bool changes = info != infos.end() && info->role != Role::kView;
  if (changes || outcome != std::string_view("OK")) audit(*session, name, ask.id, outcome);
  ready(*session);
}

void Hub::refuse(const Ask& ask, Code code, const std::string& message) {
  const Refusal why{code, cut_to(message, 400), may_retry(code)};
  answer_text_to(ask, share(error_text(ask.id, why)), text_of(code));
}

void Hub::send(const Ask& ask, FramePointer frame) {
  Session* session = find(ask.session);
  if (session == nullptr) return;
  const auto it = session->pending.find(ask.id);
  if (it == session->pending.end()) return;
  it->second.frames.push_back(frame);
  if (session->connection) enqueue(*session->connection, links_.at(*session->connection), std::move(frame));
}

void Hub::enqueue(Connection connection, Link& link, FramePointer frame) {
  // One alone may be larger: whoever asks for it again would be thrown out again.
  if (link.asked_bytes > 0 && link.asked_bytes + frame->size() > Outbox::kMostBytes) {
    return close(connection, link, 1013, Code::kTooLarge, "answers were not taken in time");
  }
  link.asked_bytes += frame->size();
  link.asked.push_back(std::move(frame));
  ready_.insert(connection);
}

void Hub::tell_all(const std::string& key, std::string text) {
  const SharedText shared = share(std::move(text));
  state_[key] = shared;
  for (auto& [number, session] : sessions_) {
    if (!session.connection) continue;
    session.outbox.newest(key, shared);
    ready(session);
  }
}

void Hub::tell(Session& session, const std::string& key, std::string text) {
  if (!session.connection) return;
  session.outbox.newest(key, share(std::move(text)));
  ready(session);
}

Session* Hub::find(std::int64_t session) {
  const auto it = sessions_.find(session);
  return it != sessions_.end() ? &it->second : nullptr;
}

void Hub::restart_layer(std::uint32_t stream, const std::string& epoch) {
  ShownLayer* layer = layers_.find(stream);
  if (layer == nullptr) return;
  layer->store.clear();
  layer->changed.clear();
  layer->epoch = epoch;
  const SharedText text = share(event_text(EpochEvent{stream, epoch}));
  for (auto& [number, session] : sessions_) {
    if (stream == kMapStream) {
      session.kept.reset();
      session.whole.reset();
    }
    const auto view = session.views.find(stream);
    if (view == session.views.end()) continue;
    view->second.restart();
    session.told_complete.erase(stream);
    if (!session.connection) continue;
    session.outbox.lossless(text);
    ready(session);
  }
}

void Hub::publish_layer(std::uint32_t stream, std::int64_t map_revision, bool synced) {
  ShownLayer* layer = layers_.find(stream);
  if (layer == nullptr) return;
  const bool news = !layer->changed.empty() || layer->map_revision != map_revision || layer->synced != synced;
  layer->map_revision = map_revision;
  layer->synced = synced;
  if (!news) return;
  std::sort(layer->changed.begin(), layer->changed.end());
  layer->changed.erase(std::unique(layer->changed.begin(), layer->changed.end()), layer->changed.end());
  for (auto& [number, session] : sessions_) {
    const auto view = session.views.find(stream);
    if (!session.connection || view == session.views.end()) continue;
    for (const BlockKey& key : layer->changed) view->second.changed(layer->store, key);
    ready(session);
  }
  layer->changed.clear();
}

Hub::Looked Hub::look(Session& session, std::uint32_t stream, const ViewRegion& region) {
  ShownLayer& layer = *layers_.find(stream);
  const auto view = session.views.find(stream);
  session.told_complete.erase(stream);
  if (stream == kMapStream && session.whole && !(session.whole->region == region)) session.whole.reset();
  ready(session);
  if (view != session.views.end()) {
    view->second.look(layer.store, region);
    return {view->second.in_view(), view->second.lacking()};
  }
  const bool kept = stream == kMapStream && session.kept;
  ClientView fresh =
      kept ? ClientView(layer.store, session.kept->region, session.kept->revision) : ClientView(layer.store, region);
  if (kept) {
    fresh.look(layer.store, region);
    session.kept.reset();
  }
  const ClientView& placed = session.views.emplace(stream, std::move(fresh)).first->second;
  return {placed.in_view(), placed.lacking()};
}

bool Hub::look_away(Session& session, std::uint32_t stream) {
  if (stream == kMapStream) session.whole.reset();
  session.told_complete.erase(stream);
  return session.views.erase(stream) > 0;
}

void Hub::tell_behind(std::int64_t now) {
  if (now - last_behind_ < kBehind) return;
  last_behind_ = now;
  for (auto& [number, session] : sessions_) {
    std::int64_t skipped = 0, lacking = 0;
    for (const auto& [stream, view] : session.views) {
      skipped += view.skipped();
      lacking += static_cast<std::int64_t>(view.lacking());
    }
    if (skipped <= session.told_skipped) continue;
    session.told_skipped = skipped;
    tell(session, "behind", event_text(BehindEvent{skipped, lacking}));
  }
}

/// Forgets blocks that have long been empty, once every client that had them knows.
void Hub::sweep() {
  for (const auto& [number, session] : sessions_) {
    if (!session.connection || session.kept) return;  // it may come back, or look again, with what it had
  }
  for (auto& [stream, layer] : layers_.all()) {
    if (!layer.changed.empty()) continue;  // views have not been told: they may lack blocks that are empty meanwhile
    for (const BlockKey& key : layer.store.emptied_before(layers_.revision())) {
      const std::int64_t revision = layer.store.revision(key);
      const bool all_know = std::all_of(sessions_.begin(), sessions_.end(), [&, &name = stream](const auto& entry) {
        const auto view = entry.second.views.find(name);
        return view == entry.second.views.end() || view->second.held(key) == 0 || view->second.held(key) >= revision;
      });
      if (all_know) layer.store.drop(key);
    }
  }
}

}  // namespace concord::hmd
