#include "session/session.hpp"

#include <algorithm>

namespace concord::hmd {
namespace {

std::size_t bytes_of(const std::vector<FramePointer>& frames) {
  std::size_t bytes = 0;
  for (const FramePointer& frame : frames) bytes += frame->size();
  return bytes;
}

}  // namespace

void RecentTexts::keep(std::int64_t id, SharedText text, std::vector<FramePointer> frames) {
  const std::size_t size = text->size(), frame_size = bytes_of(frames);
  if (!said_.emplace(id, Said{std::move(text), std::move(frames)}).second) return;
  bytes_ += size;
  frame_bytes_ += frame_size;
  order_.push_back(id);
  while (order_.size() > kMost || (bytes_ > kMostBytes && order_.size() > 1)) drop(order_.begin());
  while (frame_bytes_ > kMostFrameBytes) {
    const auto oldest =
        std::find_if(order_.begin(), order_.end(), [this](std::int64_t i) { return !said_.at(i).frames.empty(); });
    if (*oldest == id) return;
    drop(oldest);
  }
}

void RecentTexts::drop(std::deque<std::int64_t>::iterator which) {
  const auto it = said_.find(*which);
  bytes_ -= it->second.text->size();
  frame_bytes_ -= bytes_of(it->second.frames);
  said_.erase(it);
  order_.erase(which);
}

const RecentTexts::Said* RecentTexts::find(std::int64_t id) const {
  const auto it = said_.find(id);
  return it != said_.end() ? &it->second : nullptr;
}

}  // namespace concord::hmd
