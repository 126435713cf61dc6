#include "session/session.hpp"

namespace concord::hmd {

void RecentTexts::keep(std::int64_t id, SharedText text) {
  bytes_ += text->size();
  if (!texts_.emplace(id, std::move(text)).second) return;
  order_.push_back(id);
  while (order_.size() > kMost || (bytes_ > kMostBytes && order_.size() > 1)) {
    const auto it = texts_.find(order_.front());
    bytes_ -= it->second->size();
    texts_.erase(it);
    order_.pop_front();
  }
}

SharedText RecentTexts::find(std::int64_t id) const {
  const auto it = texts_.find(id);
  return it != texts_.end() ? it->second : nullptr;
}

}  // namespace concord::hmd
