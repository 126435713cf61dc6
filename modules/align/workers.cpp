#include "align/workers.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace concord {

void for_each_chunk(int threads, std::size_t chunks, const std::function<void(std::size_t)>& work) {
  if (threads <= 1 || chunks <= 1) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) work(chunk);
    return;
  }
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, chunks, work); });
}

}  // namespace concord
