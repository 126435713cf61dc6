#include "align/workers.hpp"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace concord {

void for_each_chunk(int threads, std::size_t chunks, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  const auto run = [&] {
    for (std::size_t chunk = next++; chunk < chunks; chunk = next++) work(chunk);
  };
  const std::size_t helpers = std::min<std::size_t>(std::max(threads, 1), chunks);
  std::vector<std::jthread> pool;
  for (std::size_t i = 1; i < helpers; ++i) pool.emplace_back(run);
  run();
}

}  // namespace concord
