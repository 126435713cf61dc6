#include "session/outbox.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <vector>

namespace concord::hmd {
namespace {

SharedText text(std::string content) { return std::make_shared<const std::string>(std::move(content)); }

RC_GTEST_PROP(Outbox, LosslessTextsComeWholeAndOfEachKeyTheNewest, ()) {
  Outbox outbox;
  std::deque<std::string> owed;
  std::map<std::string, std::string> newest;
  const int steps = *rc::gen::inRange(1, 100);
  for (int i = 0; i < steps; ++i) {
    const int what = *rc::gen::inRange(0, 3);
    const std::string content = std::to_string(i);
    if (what == 0) {
      outbox.lossless(text(content));
      owed.push_back(content);
    } else if (what == 1) {
      const std::string key(1, static_cast<char>('a' + *rc::gen::inRange(0, 3)));
      outbox.newest(key, text(content));
      newest[key] = content;
    } else if (const SharedText taken = outbox.take()) {
      if (!owed.empty()) {
        RC_ASSERT(*taken == owed.front());
        owed.pop_front();
      } else {
        const auto it =
            std::find_if(newest.begin(), newest.end(), [&](const auto& entry) { return entry.second == *taken; });
        RC_ASSERT(it != newest.end());
        newest.erase(it);
      }
    }
  }
  std::size_t left = 0;
  while (outbox.take() != nullptr) ++left;
  RC_ASSERT(left == owed.size() + newest.size());
  RC_ASSERT(outbox.empty() && outbox.waiting_bytes() == 0u);
}

TEST(Outbox, AReaderThatNeverReadsOverflowsAtABound) {
  Outbox outbox;
  for (int i = 0; i < 100; ++i) outbox.lossless(text(std::string(100'000, 'x')));
  EXPECT_TRUE(outbox.overflowed());
  EXPECT_EQ(outbox.waiting_bytes(), 0u) << "nothing is kept for who is to be disconnected";
  Outbox news;
  for (int i = 0; i < 100'000; ++i) news.newest("poses", text(std::string(1000, 'x')));
  EXPECT_FALSE(news.overflowed());
  EXPECT_NE(news.take(), nullptr);
  EXPECT_EQ(news.take(), nullptr);
}

RC_GTEST_PROP(Outbox, NoMoreIsSpentThanCredited, ()) {
  Outbox outbox;
  std::int64_t credit = 0, spent = 0;
  for (int i = 0; i < 50; ++i) {
    const std::int64_t said = *rc::gen::inRange(0, 10'000);
    outbox.credit(said);
    credit = std::max(credit, said);
    const auto bytes = static_cast<std::size_t>(*rc::gen::inRange(0, 3000));
    if (!outbox.affords(bytes)) continue;
    outbox.spend(bytes);
    spent += static_cast<std::int64_t>(bytes);
    RC_ASSERT(spent <= credit);
  }
}

}  // namespace
}  // namespace concord::hmd
