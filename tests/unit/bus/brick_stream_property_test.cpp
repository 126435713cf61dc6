#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "stream_world.hpp"

namespace concord::test {
namespace {

constexpr std::size_t kMostCopies = 3;

struct Act {
  std::uint32_t kind = 0;
  std::uint32_t a = 0;
  std::uint32_t b = 0;
};

std::ostream& operator<<(std::ostream& out, const Act& act) {
  return out << "{" << act.kind << ", " << act.a << ", " << act.b << "}";
}

rc::Gen<Act> arbitrary_act() {
  return rc::gen::apply(
      [](std::uint32_t kind, std::uint32_t a, std::uint32_t b) {
        return Act{kind, a, b};
      },
      rc::gen::inRange<std::uint32_t>(0, 14), rc::gen::inRange<std::uint32_t>(0, 1000),
      rc::gen::inRange<std::uint32_t>(0, 1000));
}

BrickIndex index_of(std::uint32_t number) {
  const auto n = static_cast<std::int32_t>(number);
  return {n % 4 - 2, n / 4 % 4, n / 16 % 4};
}

void perform(StreamWorld& world, const Act& act) {
  switch (act.kind) {
    case 0:
    case 1:
    case 2:
      for (std::uint32_t i = 0; i < act.b % 20; ++i) world.set(index_of(act.a + i), noisy_brick(act.b + i));
      return;
    case 3: return world.set(index_of(act.a), noisy_brick(act.b, 3));
    case 4: return world.set(index_of(act.a), Brick());
    case 5: return world.begin("frame" + std::to_string(act.a % 3));
    case 6: return world.restart_sender();
    case 7:  // it comes back with another map in the same frame
      for (std::uint32_t i = 0; i < 5; ++i)
        world.set(index_of(act.a + 3 * i), i % 2 == 0 ? Brick() : noisy_brick(act.b));
      return world.restart_sender();
    case 8:
      if (world.copies().size() < kMostCopies) world.join();
      return;
    case 9:
      if (!world.copies().empty()) world.restart_copy(act.a % world.copies().size(), act.b % 2 == 0);
      return;
    case 10: return world.end();
    case 11: return world.clear();
    default: return world.run(act.b * 500);
  }
}

void all_copies_end_equal(Link link) {
  const auto acts = *rc::gen::container<std::vector<Act>>(arbitrary_act());
  StreamWorld world(link);
  world.begin("frame0");
  world.join();
  for (const Act& act : acts) perform(world, act);
  world.begin("last");
  world.set({0, 0, 0}, noisy_brick(acts.size()));
  RC_ASSERT(world.settle(20 * StreamWorld::kSecond) >= 0);
  for (const auto& copy : world.copies()) {
    RC_ASSERT(digest(copy->map()) == digest(world.map()));
    RC_ASSERT(copy->receiver().missing() == 0);
    RC_ASSERT(copy->idle_changes() == 0);
    // The digest mends what goes wrong, but nothing may go wrong, unless an old digest overtakes newer packets.
    if (link.late == 0) RC_ASSERT(copy->counters().get("stream_mismatch." + kStream) == 0);
  }
}

/// As above, but the stream is not begun anew in the end: what is left over must not hang on that.
void all_copies_end_equal_in_their_frame(Link link) {
  const auto acts = *rc::gen::container<std::vector<Act>>(arbitrary_act());
  StreamWorld world(link);
  world.begin("frame0");
  world.join();
  bool speaking = true;
  for (const Act& act : acts) {
    perform(world, act);
    if (act.kind == 5) speaking = true;
    if (act.kind == 10) speaking = false;
  }
  if (!speaking) world.begin("frame0");
  RC_ASSERT(world.settle(20 * StreamWorld::kSecond) >= 0);
  for (const auto& copy : world.copies()) {
    if (link.late == 0) RC_ASSERT(copy->counters().get("stream_mismatch." + kStream) == 0);
  }
}

RC_GTEST_PROP(BrickStreamProperty, copies_end_equal_on_a_good_link, ()) { all_copies_end_equal({}); }
RC_GTEST_PROP(BrickStreamProperty, copies_end_equal_when_messages_are_doubled_and_late, ()) {
  all_copies_end_equal({0, 30, 30});
}
RC_GTEST_PROP(BrickStreamProperty, copies_end_equal_with_a_twentieth_lost, ()) {
  all_copies_end_equal_in_their_frame({5, 5, 5});
}
RC_GTEST_PROP(BrickStreamProperty, copies_end_equal_with_a_tenth_lost_in_order, ()) {
  all_copies_end_equal_in_their_frame({10, 10, 0});
}
RC_GTEST_PROP(BrickStreamProperty, copies_end_equal_with_a_fifth_lost, ()) {
  all_copies_end_equal_in_their_frame({20, 10, 20});
}

}  // namespace
}  // namespace concord::test
