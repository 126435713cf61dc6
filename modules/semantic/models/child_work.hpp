#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>

#include "core/byte_stream.hpp"
#include "core/error.hpp"

namespace concord {

/// Work on a model in a process of its own, so that a hostile one can neither crash nor fill nor hold up this one: what
/// it is given is kMaxModelMemory of memory and kMaxModelSeconds of processor time. It sees this process as it was when
/// it began, at no cost, and leaves nothing but its reply (and files that it writes). It ends with this process.
class ChildWork {
 public:
  using Work = std::function<Result<Bytes>()>;

  /// `work` must not touch databases, logs or the bus. Refused: kIo, no process could be made.
  [[nodiscard]] static Result<ChildWork> begin(const Work& work);
  ChildWork(ChildWork&& other) noexcept;
  ChildWork& operator=(ChildWork&&) = delete;
  ~ChildWork();  ///< who still works is killed

  /// What came of it, once, when it has ended; nothing before that. Never blocks. Refused: what `work` refuses;
  /// kTooLarge, it took too much memory or time or its reply is over kMostReply; kMalformed, it crashed.
  [[nodiscard]] std::optional<Result<Bytes>> poll();
  /// The same, waited for. @pre it was not told yet.
  [[nodiscard]] Result<Bytes> wait();

  static constexpr std::size_t kMostReply = 1'500'000'000;

 private:
  ChildWork(pid_t child, int from);
  [[nodiscard]] bool read_more();
  [[nodiscard]] Result<Bytes> end();

  pid_t child_;
  int from_;
  Bytes reply_;
};

inline constexpr std::uint64_t kMaxModelMemory = 6'000'000'000;
inline constexpr unsigned kMaxModelSeconds = 60;

}  // namespace concord
