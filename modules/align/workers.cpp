#include "align/workers.hpp"

#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace concord {
namespace {

thread_local const std::stop_token* stop_of_this_thread = nullptr;

/// What the thread that waits heeds, a thread that works for it heeds as well.
class Heeding {
 public:
  explicit Heeding(const std::stop_token* stop) : own_(std::exchange(stop_of_this_thread, stop)) {}
  ~Heeding() { stop_of_this_thread = own_; }
  Heeding(const Heeding&) = delete;
  Heeding& operator=(const Heeding&) = delete;

 private:
  const std::stop_token* own_;
};

}  // namespace

void for_each_chunk(int threads, std::size_t chunks, const std::function<void(std::size_t)>& work) {
  // Read here: the arena's threads have none of their own.
  const std::stop_token* stop = stop_of_this_thread;
  const auto one = [&work, stop](std::size_t chunk) {
    const Heeding heeding(stop);
    look_for_stop();
    work(chunk);
  };
  if (threads <= 1 || chunks <= 1) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) one(chunk);
    return;
  }
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, chunks, one); });
}

void look_for_stop() {
  if (stop_of_this_thread != nullptr && stop_of_this_thread->stop_requested()) throw Stopped();
}

std::stop_token stop_in_scope() { return stop_of_this_thread != nullptr ? *stop_of_this_thread : std::stop_token(); }

StopScope::StopScope(std::stop_token stop)
    : stop_(std::move(stop)), outer_(std::exchange(stop_of_this_thread, &stop_)) {}

StopScope::~StopScope() { stop_of_this_thread = outer_; }

}  // namespace concord
