#include "semantic/work_queue.hpp"

#include <cassert>
#include <utility>

namespace concord {
namespace {

constexpr std::int64_t kLookPeriod = 10'000;  ///< microseconds

}  // namespace

WorkQueue::WorkQueue(Bus& bus, std::launch how) : how_(how) {
  bus.every(kLookPeriod, [this] { look(); });
}

void WorkQueue::add(ChildWork::Work work, Done done) {
  assert(has_room());
  waiting_.push_back({std::move(work), std::move(done)});
}

void WorkQueue::look() {
  if (!running_) begin_next();
  if (!running_) return;
  auto reply = how_ == std::launch::async ? running_->poll() : running_->wait();
  if (reply) end(std::move(*reply));
}

void WorkQueue::begin_next() {
  if (waiting_.empty()) return;
  Job job = std::move(waiting_.front());
  waiting_.pop_front();
  when_done_ = std::move(job.done);
  auto begun = ChildWork::begin(job.work);
  if (!begun) return end(tl::unexpected(begun.error()));
  running_.emplace(std::move(*begun));
}

/// What is called may add more.
void WorkQueue::end(Result<Bytes> reply) {
  running_.reset();
  std::exchange(when_done_, nullptr)(std::move(reply));
}

}  // namespace concord
