#include "bridge/look_judge.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

namespace concord::hmd {
namespace {

constexpr std::int64_t kStep = 5'000;  // microseconds
constexpr int kNice = 10;              ///< the loop comes first where there are few cores

}  // namespace

LookJudge::LookJudge(Bus& bus, std::launch how) : how_(how) {
  bus.every(kStep, [this] { step(); });
}

bool LookJudge::offer(Look look) {
  const auto same =
      std::count_if(waiting_.begin(), waiting_.end(), [&](const Look& other) { return other.agent == look.agent; });
  const std::size_t bytes = look.frame.body.size();
  if (static_cast<std::size_t>(same) >= kMostOfOne || bytes_ + bytes > kMostBytes) return false;
  bytes_ += bytes;
  waiting_.push_back(std::move(look));
  return true;
}

void LookJudge::step() {
  if (judged_) return hand_over();
  if (!running_.valid()) return begin();
  if (running_.wait_for(std::chrono::seconds(0)) == std::future_status::timeout) return;
  judged_ = running_.get();
  hand_over();
}

void LookJudge::begin() {
  if (waiting_.empty()) return;
  Look& look = waiting_.front();
  bytes_ -= look.frame.body.size();
  if (const auto room = look.has_room(); !room) {
    if (look.anew) look.mapper->end_sequence();
    judged_ = Judged{tl::unexpected(room.error()), {}, 0, look.mapper->bytes()};
    return;
  }
  running_ = std::async(how_, [how = how_, mapper = look.mapper, anew = look.anew,
                               frame = std::make_shared<PackedFrame>(std::move(look.frame))] {
    // The thread's own; that it could not be said changes nothing of what comes out.
    if (how == std::launch::async) (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
    if (anew) mapper->end_sequence();
    return judge(*mapper, std::move(*frame));
  });
}

/// In turns: a look may change a whole room.
void LookJudge::hand_over() {
  const Look& look = waiting_.front();
  const std::size_t end = std::min(judged_->changed.size(), handed_ + kBricksOfATurn);
  for (; handed_ < end; ++handed_) {
    look.on_brick(judged_->changed[handed_].first, std::move(judged_->changed[handed_].second));
  }
  if (handed_ < judged_->changed.size()) return;
  const Look last = std::move(waiting_.front());
  const Judged judged = std::move(*judged_);
  waiting_.pop_front();
  judged_.reset();
  handed_ = 0;
  last.on_end(judged);
}

}  // namespace concord::hmd
