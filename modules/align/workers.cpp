#include "align/workers.hpp"

#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace concord {
namespace {

thread_local const std::stop_token* stop_of_this_thread = nullptr;

}  // namespace

void for_each_chunk(int threads, std::size_t chunks, const std::function<void(std::size_t)>& work) {
  // Read here: the arena's threads have none of their own.
  const std::stop_token* stop = stop_of_this_thread;
  const auto one = [&work, stop](std::size_t chunk) {
    if (stop != nullptr && stop->stop_requested()) throw Stopped();
    work(chunk);
  };
  if (threads <= 1 || chunks <= 1) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) one(chunk);
    return;
  }
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, chunks, one); });
}

StopScope::StopScope(std::stop_token stop)
    : stop_(std::move(stop)), outer_(std::exchange(stop_of_this_thread, &stop_)) {}

StopScope::~StopScope() { stop_of_this_thread = outer_; }

}  // namespace concord
