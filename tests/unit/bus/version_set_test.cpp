#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <set>

#include "bus/brick_stream.hpp"

namespace concord::test {
namespace {

constexpr std::int64_t kMost = 60;

struct Pair {
  VersionSet set;
  std::set<std::int64_t> oracle;
};

/// Both after the same random additions and removals.
Pair arbitrary_pair() {
  Pair pair;
  const auto steps = *rc::gen::container<std::vector<std::tuple<bool, std::int64_t, std::int64_t>>>(rc::gen::tuple(
      rc::gen::arbitrary<bool>(), rc::gen::inRange<std::int64_t>(1, kMost + 1), rc::gen::inRange<std::int64_t>(0, 12)));
  for (const auto& [add, first, more] : steps) {
    const std::int64_t last = std::min(first + more, kMost);
    if (add) {
      pair.set.add(first, last);
    } else {
      pair.set.remove(first, last);
    }
    for (std::int64_t v = first; v <= last; ++v) {
      if (add) {
        pair.oracle.insert(v);
      } else {
        pair.oracle.erase(v);
      }
    }
  }
  return pair;
}

RC_GTEST_PROP(VersionSet, holds_what_a_plain_set_holds, ()) {
  const auto [set, oracle] = arbitrary_pair();
  std::set<std::int64_t> held;
  std::int64_t before = -1;
  for (const auto& [first, last] : set.intervals()) {
    RC_ASSERT(first <= last);
    RC_ASSERT(first > before + 1);  // merged
    before = last;
    for (std::int64_t v = first; v <= last; ++v) held.insert(v);
  }
  RC_ASSERT(held == oracle);
  RC_ASSERT(set.empty() == oracle.empty());
  RC_ASSERT(set.highest() == (oracle.empty() ? 0 : *oracle.rbegin()));
}

RC_GTEST_PROP(VersionSet, answers_like_a_plain_set, ()) {
  const auto [set, oracle] = arbitrary_pair();
  const auto first = *rc::gen::inRange<std::int64_t>(1, kMost + 1);
  const auto last = *rc::gen::inRange<std::int64_t>(first, kMost + 3);
  bool all = true;
  bool touching = oracle.contains(first - 1) || oracle.contains(last + 1);
  for (std::int64_t v = first; v <= last; ++v) {
    all = all && oracle.contains(v);
    touching = touching || oracle.contains(v);
  }
  RC_ASSERT(set.contains(first, last) == all);
  RC_ASSERT(set.touches(first, last) == touching);

  std::set<std::int64_t> missing;
  for (const auto& [from, to] : set.missing(last)) {
    for (std::int64_t v = from; v <= to; ++v) missing.insert(v);
  }
  for (std::int64_t v = 1; v <= last; ++v) RC_ASSERT(missing.contains(v) != oracle.contains(v));
  if (!missing.empty()) RC_ASSERT(*missing.rbegin() <= last);
}

}  // namespace
}  // namespace concord::test
