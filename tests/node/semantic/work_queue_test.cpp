#include "semantic/work_queue.hpp"

#include <unistd.h>

#include <csignal>
#include <optional>

#include <gtest/gtest.h>

#include "bus/lockstep_bus.hpp"

namespace concord {
namespace {

class WorkQueueTest : public testing::Test {
 protected:
  /// Until that many are done, in whatever time the other processes take.
  void run_until_done(std::size_t count) {
    while (replies_.size() < count) bus_.advance_to(bus_.now() + 10'000);
  }
  WorkQueue::Done note() {
    return [this](Result<Bytes> reply) { replies_.push_back(std::move(reply)); };
  }

  LockstepBus bus_{1'000'000};
  std::vector<Result<Bytes>> replies_;
};

TEST_F(WorkQueueTest, TheBusGoesOnWhileItWorks) {
  int gate[2];
  ASSERT_EQ(pipe(gate), 0);
  WorkQueue queue(bus_, std::launch::async);
  queue.add(
      [&gate]() -> Result<Bytes> {
        std::uint8_t byte = 0;
        return read(gate[0], &byte, 1) == 1 ? Bytes{byte} : Bytes{};
      },
      note());
  queue.add([]() -> Result<Bytes> { return Bytes{8}; }, note());
  bus_.advance_to(bus_.now() + 5'000'000);
  EXPECT_TRUE(replies_.empty());
  const std::uint8_t seven = 7;
  ASSERT_EQ(write(gate[1], &seven, 1), 1);
  run_until_done(2);
  EXPECT_EQ(*replies_[0], Bytes{7});
  EXPECT_EQ(*replies_[1], Bytes{8});
  EXPECT_TRUE(queue.is_idle());
  close(gate[0]);
  close(gate[1]);
}

TEST_F(WorkQueueTest, ALargeReplyComesWholeAndARefusalInItsWords) {
  WorkQueue queue(bus_, std::launch::async);
  queue.add([]() -> Result<Bytes> { return Bytes(40'000'000, 5); }, note());
  queue.add([]() -> Result<Bytes> { return refuse(Code::kTooLarge, "so large"); }, note());
  run_until_done(2);
  ASSERT_TRUE(replies_[0]);
  EXPECT_EQ(*replies_[0], Bytes(40'000'000, 5));
  ASSERT_FALSE(replies_[1]);
  EXPECT_EQ(replies_[1].error().code, Code::kTooLarge);
  EXPECT_EQ(replies_[1].error().message, "so large");
}

TEST_F(WorkQueueTest, WhatCrashesOrIsKilledIsRefusedAndTheNextIsDone) {
  WorkQueue queue(bus_, std::launch::async);
  queue.add([]() -> Result<Bytes> { std::abort(); }, note());
  queue.add([]() -> Result<Bytes> { return raise(SIGKILL) == 0 ? Bytes{} : Bytes{1}; }, note());
  queue.add([]() -> Result<Bytes> { throw std::bad_alloc(); }, note());
  queue.add([]() -> Result<Bytes> { return Bytes{3}; }, note());
  run_until_done(4);
  EXPECT_EQ(replies_[0].error().code, Code::kMalformed);
  EXPECT_EQ(replies_[1].error().code, Code::kTooLarge);
  EXPECT_EQ(replies_[2].error().code, Code::kTooLarge);
  EXPECT_EQ(*replies_[3], Bytes{3});
}

TEST_F(WorkQueueTest, OneThatGoesTakesWhatWorksForItAlong) {
  int alive[2];
  ASSERT_EQ(pipe(alive), 0);
  {
    WorkQueue queue(bus_, std::launch::async);
    queue.add(
        [&alive]() -> Result<Bytes> {
          const pid_t self = getpid();
          (void)!write(alive[1], &self, sizeof(self));
          for (;;) pause();
        },
        note());
    bus_.advance_to(bus_.now() + 20'000);
    pid_t child = 0;
    ASSERT_EQ(read(alive[0], &child, sizeof(child)), static_cast<ssize_t>(sizeof(child)));
    EXPECT_EQ(kill(child, 0), 0);
  }
  close(alive[1]);
  std::uint8_t byte = 0;
  EXPECT_EQ(read(alive[0], &byte, 1), 0) << "nobody has the other end any more";
  EXPECT_TRUE(replies_.empty());
  close(alive[0]);
}

}  // namespace
}  // namespace concord
