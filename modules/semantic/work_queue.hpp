#pragma once

#include <deque>
#include <functional>
#include <future>
#include <optional>

#include "bus/bus.hpp"
#include "semantic/models/child_work.hpp"

namespace concord {

/// Work that takes longer than the bus may wait: one after the other, each in a process of its own.
class WorkQueue {
 public:
  using Done = std::function<void(Result<Bytes>)>;

  /// @param how deferred: each is waited for, so that on log time it takes none.
  WorkQueue(Bus& bus, std::launch how);
  WorkQueue(const WorkQueue&) = delete;
  WorkQueue& operator=(const WorkQueue&) = delete;

  static constexpr std::size_t kMost = 32;  ///< that wait
  [[nodiscard]] bool has_room() const { return waiting_.size() < kMost; }
  [[nodiscard]] bool is_idle() const { return waiting_.empty() && !running_; }

  /// `done` is called from the bus, later. @pre has_room.
  void add(ChildWork::Work work, Done done);

 private:
  void look();
  void begin_next();
  void end(Result<Bytes> reply);

  struct Job {
    ChildWork::Work work;
    Done done;
  };
  std::launch how_;
  std::deque<Job> waiting_;
  std::optional<ChildWork> running_;
  Done when_done_;  ///< of what runs
};

}  // namespace concord
