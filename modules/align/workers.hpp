#pragma once

#include <cstddef>
#include <functional>

namespace concord {

/// Calls `work(chunk)` once for each chunk from 0 to `chunks - 1`, on up to `threads` threads, and waits for all.
/// Which thread takes which chunk is open: results are the same for any number of threads only where each chunk
/// writes to a place of its own and whoever reads them does so in the order of chunks.
void for_each_chunk(int threads, std::size_t chunks, const std::function<void(std::size_t)>& work);

/// Chunks of `size` items that `items` need.
[[nodiscard]] constexpr std::size_t chunks_of(std::size_t items, std::size_t size) { return (items + size - 1) / size; }

}  // namespace concord
