#include "session/outbox.hpp"

#include <algorithm>
#include <utility>

namespace concord::hmd {

void Outbox::lossless(SharedText text) {
  if (overflowed_) return;
  if (bytes_ + text->size() > kMostBytes || lossless_.size() >= kMostTexts) {
    overflowed_ = true;
    lossless_.clear();
    bytes_ = 0;
    return;
  }
  bytes_ += text->size();
  lossless_.push_back(std::move(text));
}

void Outbox::newest(const std::string& key, SharedText text) {
  if (newest_.insert_or_assign(key, std::move(text)).second) turns_.push_back(key);
}

void Outbox::forget(const std::string& key) {
  if (newest_.erase(key) > 0) turns_.erase(std::find(turns_.begin(), turns_.end(), key));
}

SharedText Outbox::take() {
  SharedText text;
  if (!lossless_.empty()) {
    text = std::move(lossless_.front());
    lossless_.pop_front();
    bytes_ -= text->size();
  } else if (!turns_.empty()) {
    text = std::move(newest_.extract(turns_.front()).mapped());
    turns_.pop_front();
  }
  return text;
}

}  // namespace concord::hmd
