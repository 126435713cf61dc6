#include <dlfcn.h>
#include <unistd.h>

#include <atomic>

#include "merge_station.hpp"

namespace {

std::atomic<int> syncs{0};

}  // namespace

// In place of the system's, for this whole program: SQLite calls these.
extern "C" int fdatasync(int fd) {
  static const auto real = reinterpret_cast<int (*)(int)>(::dlsym(RTLD_NEXT, "fdatasync"));
  ++syncs;
  return real(fd);
}

extern "C" int fsync(int fd) {
  static const auto real = reinterpret_cast<int (*)(int)>(::dlsym(RTLD_NEXT, "fsync"));
  ++syncs;
  return real(fd);
}

namespace concord {
namespace {

using SyncCountTest = MergeStation;

TEST_F(SyncCountTest, EachCorrectionIsOnDiskOnceBeforeItsAnswerAndBeforeAnybodySeesIt) {
  send_wall();
  ASSERT_TRUE(add("first", {50, 50, 50}).ok);
  int before = 0, at_answer = -1, at_map = -1;
  bus_->subscribe("out/answer", [&](const std::string&, auto) { at_answer = syncs - before; });
  bus_->subscribe("out/map/bricks", [&](const std::string&, auto) {
    if (at_map < 0) at_map = syncs - before;
  });
  const auto syncs_of = [&](const std::function<Answer()>& request) {
    before = syncs;
    at_answer = at_map = -1;
    EXPECT_TRUE(request().ok);
    EXPECT_EQ(at_answer, syncs - before);
    EXPECT_TRUE(at_map < 0 || at_map == at_answer) << "not seen before it is on disk";
    return at_answer;
  };
  EXPECT_EQ(syncs_of([&] { return add("e1", {0, 0, 0}); }), 1);
  EXPECT_EQ(at_map, 1);
  EXPECT_EQ(syncs_of([&] { return undo("u1", "e1"); }), 1);
  EXPECT_EQ(syncs_of([&] { return place("t1", Transform::Identity()); }), 1);
  const ZoneRequest zone{"z1", "eva", ZoneRequest::Op::kAdd, "door", {}, Box{{0, 0, 0}, {1, 1, 1}}, {}, -1, 0};
  EXPECT_EQ(syncs_of([&] { return ask("in/zone", encode(zone)); }), 1);
  EXPECT_EQ(syncs_of([&] { return ask("in/weight", encode(WeightRequest{"w1", "eva", "robot1", 7, 0})); }), 1);
  EXPECT_EQ(syncs_of([&] { return add("e1", {0, 0, 0}); }), 0) << "what is on disk already needs no more";
}

}  // namespace
}  // namespace concord
