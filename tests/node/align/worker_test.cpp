#include <atomic>
#include <future>
#include <new>
#include <thread>

#include "align_station.hpp"

// What computes beside the bus: it fails, it is stopped, and it ends after what it was computed from has changed.

namespace concord::test {
namespace {

const Transform kT_map_left = transform(10.0, 5.0, 0.0, 0.3);

class FailingStation : public AlignStation {
 protected:
  FailingStation()
      : AlignStation(std::launch::deferred, [this](const AlignTask& task, int threads, std::stop_token stop) {
          ++computed_;
          if (fails_) throw std::bad_alloc();
          return carry_out(task, threads, std::move(stop));
        }) {
    send("robot1", left_part());
    send("robot2", right_part());
    align_by_hand("robot1", kT_map_left);
  }
  bool fails_ = true;
  int computed_ = 0;
};

TEST_F(FailingStation, ARequestIsAnsweredAndTheNextOneIsDone) {
  const AlignRequest request = guess_of("a", "robot2", "", kT_map_left * kT_left_right);
  EXPECT_EQ(this->request(request).code, "BUSY");
  answers_.clear();
  run();
  ASSERT_FALSE(answers_.empty());
  EXPECT_EQ(answers_.back().id, "a");
  EXPECT_EQ(answers_.back().code, "TOO_LARGE");
  EXPECT_EQ(counters_.get("refused.in/align.TOO_LARGE"), 1);
  fails_ = false;
  EXPECT_TRUE(found(request).ok) << "the queue stands still";
}

TEST_F(FailingStation, TheWatchDoesNotTryAgainAtOnce) {
  align_by_hand("robot2", transform(0.2, -0.15, 0.0, degrees(1.5)) * kT_map_left * kT_left_right);
  run(60'000'000);
  EXPECT_EQ(computed_, 2) << "each of the two once, until something changes";
  EXPECT_EQ(counters_.get("refused.watch.TOO_LARGE"), 2);
}

/// A real thread beside the bus, that is at it until it is told to stop.
class BesideStation : public AlignStation {
 protected:
  BesideStation()
      : AlignStation(std::launch::async, [this](const AlignTask& task, int, const std::stop_token& stop) {
          begun_.set_value();
          std::promise<void> asked;
          const std::stop_callback on_stop(stop, [&] { asked.set_value(); });
          asked.get_future().wait();
          ended_.set_value(task.id);
          return Result<Alignment>(refuse(Code::kExpired, "stopped"));
        }) {
    send("robot1", left_part());
    send("robot2", right_part());
    align_by_hand("robot1", kT_map_left);
    EXPECT_EQ(request(guess_of("a", "robot2", "", kT_map_left * kT_left_right)).code, "BUSY");
    run(100'000);
    begun_.get_future().wait();
  }
  std::promise<void> begun_;
  std::promise<std::string> ended_;
};

TEST_F(BesideStation, WhatIsDroppedStopsAndIsNotAnswered) {
  EXPECT_TRUE(decide("d", AlignDecision::Op::kDrop, "a").ok);
  EXPECT_EQ(ended_.get_future().get(), "a");
  answers_.clear();
  run();
  EXPECT_TRUE(answers_.empty()) << answers_.back().message;
  EXPECT_TRUE(results_.empty());
  const Transform T = kT_map_left * kT_left_right;
  EXPECT_EQ(request(guess_of("a", "robot2", "", T)).code, "EXPIRED") << "who asked goes on asking";
  run();
  EXPECT_TRUE(results_.empty()) << "it was carried out anew";
}

TEST_F(BesideStation, TheProcessEndsWhileItComputes) {
  node_.reset();
  EXPECT_EQ(ended_.get_future().get(), "a");
}

/// A look that goes on until it is told to stop, beside the bus.
class LookingStation : public AlignStation {
 protected:
  LookingStation()
      : AlignStation(std::launch::async, [this](const AlignTask& task, int threads, std::stop_token stop) {
          if (!task.is_recheck || has_looked_.exchange(true)) return carry_out(task, threads, std::move(stop));
          begun_.set_value();
          std::promise<void> asked;
          const std::stop_callback on_stop(stop, [&] { asked.set_value(); });
          asked.get_future().wait();
          ended_.set_value();
          return Result<Alignment>(refuse(Code::kExpired, "stopped"));
        }) {
    send("robot1", left_part());
    send("robot2", right_part());
    align_by_hand("robot1", kT_map_left);
    align_by_hand("robot2", kT_map_left * kT_left_right);
    run(10'000'000);
    begun_.get_future().wait();
  }
  std::atomic<bool> has_looked_ = false;
  std::promise<void> begun_;
  std::promise<void> ended_;
};

TEST_F(LookingStation, IsStoppedWhenAPersonAsks) {
  EXPECT_EQ(request(guess_of("a", "robot2", "", kT_map_left * kT_left_right)).code, "BUSY");
  ended_.get_future().get();  // else it waits here for ever
  EXPECT_EQ(counters_.get("looks"), 0) << "what was stopped counts as a look";
  Answer answer;
  while (answer.code.empty() || answer.code == "BUSY") {
    run(100'000);
    answer = request(guess_of("a", "robot2", "", kT_map_left * kT_left_right));
    std::this_thread::yield();
  }
  EXPECT_EQ(answer.id, "a");
  EXPECT_TRUE(answer.ok) << answer.message;
}

/// Somebody moves the agent while it is looked at.
class MovingStation : public AlignStation {
 protected:
  MovingStation()
      : AlignStation(std::launch::deferred, [this](const AlignTask& task, int threads, std::stop_token stop) {
          auto found = carry_out(task, threads, std::move(stop));
          if (task.is_recheck && is_to_move_) {
            is_to_move_ = false;
            set_place("robot2", kT_left_right);
            bus_->deliver();
          }
          return found;
        }) {
    send("robot1", left_part());
    send("robot2", right_part());
    align_by_hand("robot1", Transform::Identity());
  }
  bool is_to_move_ = true;
};

TEST_F(MovingStation, WhatIsFoundOfWhereItNoLongerLiesIsNotSaid) {
  align_by_hand("robot2", transform(0.2, -0.15, 0.0, degrees(1.5)) * kT_left_right);
  run(600'000'000);  // a look is paid for by a pause
  EXPECT_FALSE(is_to_move_) << "nobody was looked at";
  EXPECT_TRUE(results_.empty()) << results_.back().evidence.message;
  EXPECT_GE(counters_.get("looks"), 3) << "what was found of no use is looked at again";
}

}  // namespace
}  // namespace concord::test
