#include "view/client_view.hpp"

#include <algorithm>

namespace concord::hmd {
namespace {

constexpr std::size_t kManyForgotten = 256;

}  // namespace

ClientView::ClientView(const BlockStore& store, ViewRegion region) { look(store, std::move(region)); }

ClientView::ClientView(const BlockStore& store, ViewRegion region, std::int64_t revision) : region_(region) {
  store.for_each([&](const BlockKey& key, std::int64_t changed, bool filled) {
    if (!hmd::in_view(region, key)) return;
    // It has it as of `revision`: of a block that is empty, or came later, that may be nothing.
    if (changed <= revision ? filled : true) held_[key] = std::min(changed, revision);
  });
  look(store, std::move(region));
}

void ClientView::look(const BlockStore& store, ViewRegion region) {
  region_ = std::move(region);
  lacking_.clear();
  forgotten_.clear();
  seen_ = 0;
  // What is out of view is still with the client until it is told: it may come back before that.
  for (const auto& [key, revision] : held_) {
    if (!hmd::in_view(region_, key)) forgotten_.push_back(key);
  }
  store.for_each([&](const BlockKey& key, std::int64_t revision, bool filled) {
    if (!hmd::in_view(region_, key)) return;
    if (filled) ++seen_;
    if (held(key) < revision && (filled || held_.contains(key))) want(key);
  });
}

void ClientView::want(const BlockKey& key) { lacking_.emplace(distance_to(region_, key), key); }

std::int64_t ClientView::held(const BlockKey& key) const {
  const auto it = held_.find(key);
  return it != held_.end() ? it->second : 0;
}

void ClientView::changed(const BlockStore& store, const BlockKey& key) {
  if (!hmd::in_view(region_, key)) return;
  // A block may have been sent, as it is now, between the change and this telling of it.
  if (held(key) != 0 && held(key) >= store.revision(key)) return;
  const std::pair<double, BlockKey> entry{distance_to(region_, key), key};
  if (lacking_.contains(entry)) {
    ++skipped_;
    // Empty again before the client ever heard of it.
    if (!store.filled(key) && !held_.contains(key)) lacking_.erase(entry);
    return;
  }
  if (store.filled(key) || held_.contains(key)) lacking_.insert(entry);
}

void ClientView::restart() {
  held_.clear();
  lacking_.clear();
  forgotten_.clear();
  seen_ = 0;
}

std::optional<ClientView::Due> ClientView::nearest() const {
  if (lacking_.empty()) return std::nullopt;
  const BlockKey& key = lacking_.begin()->second;
  return Due{key, held(key)};
}

void ClientView::sent(const BlockStore& store, const BlockKey& key) {
  lacking_.erase({distance_to(region_, key), key});
  held_[key] = store.revision(key);
}

std::vector<BlockKey> ClientView::take_forgotten() {
  std::vector<BlockKey> taken;
  if (forgotten_.empty() || (!lacking_.empty() && forgotten_.size() < kManyForgotten)) return taken;
  const int level = forgotten_.front().level;
  std::erase_if(forgotten_, [&](const BlockKey& key) {
    if (key.level != level) return false;
    taken.push_back(key);
    held_.erase(key);
    return true;
  });
  return taken;
}

}  // namespace concord::hmd
