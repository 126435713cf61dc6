#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <stop_token>

namespace concord {

/// Calls `work(chunk)` once for each chunk from 0 to `chunks - 1`, on up to `threads` threads, and waits for all.
/// Which thread takes which chunk is open: results are the same for any number of threads only where each chunk
/// writes to a place of its own and whoever reads them does so in the order of chunks.
/// @throws Stopped: see StopScope; and what `work` throws.
void for_each_chunk(int threads, std::size_t chunks, const std::function<void(std::size_t)>& work);

/// Chunks of `size` items that `items` need.
[[nodiscard]] constexpr std::size_t chunks_of(std::size_t items, std::size_t size) { return (items + size - 1) / size; }

/// Nobody waits any longer for what is computed.
class Stopped : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "nobody waits for it any longer"; }
};

/// While it lives, for_each_chunk on this thread throws Stopped before the next chunk once a stop is asked for, and so
/// does look_for_stop, here and in the chunks. All long loops of alignment go through one of the two, so whoever calls
/// them need not know of it, and there is no half an answer.
class StopScope {
 public:
  explicit StopScope(std::stop_token stop);
  ~StopScope();
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;

 private:
  std::stop_token stop_;
  const std::stop_token* outer_;
};

/// For a loop outside of for_each_chunk, or a long one within a chunk. @throws Stopped.
void look_for_stop();

/// The same for a loop of many short steps: it looks at the first one, and then at each 1024th.
class StopLook {
 public:
  void step() {
    if ((steps_++ & 1023U) == 0) look_for_stop();
  }

 private:
  std::uint32_t steps_ = 0;
};

/// What this thread is to heed: for loops elsewhere, which know of nothing but tokens.
[[nodiscard]] std::stop_token stop_in_scope();

}  // namespace concord
