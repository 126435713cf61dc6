#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>
#include <set>

#include "view/client_view.hpp"

namespace concord::hmd {
namespace {

/// What a client holds: by block, its chunks.
class Mirror {
 public:
  void take(const Bytes& bytes) {
    const auto frame = read_frame(bytes).value();
    const auto content = read_block(frame).value();
    auto& block = blocks_[{frame.head.level, content.block}];
    if (frame.head.whole) block.clear();
    std::size_t next = 0;
    for (int i = 0; i < 64; ++i) {
      const std::uint64_t bit = std::uint64_t{1} << i;
      if ((content.told & bit) != 0) block.erase(i);
      if ((content.filled & bit) != 0) block[i] = content.chunks[next++];
    }
    if (block.empty()) blocks_.erase({frame.head.level, content.block});
  }
  void forget(const BlockKey& key) { blocks_.erase(key); }
  void clear() { blocks_.clear(); }

  /// Cells of one level, in its lattice.
  [[nodiscard]] std::set<VoxelIndex> cells(int level) const {
    std::set<VoxelIndex> cells;
    for (const auto& [key, chunks] : blocks_) {
      if (key.level != level) continue;
      for (const auto& [number, bits] : chunks) {
        for (int v = 0; v < 4096; ++v) {
          if ((bits[static_cast<std::size_t>(v / 8)] >> (v % 8) & 1) == 0) continue;
          cells.insert({key.index.x * 64 + (number & 3) * 16 + (v & 15),
                        key.index.y * 64 + (number >> 2 & 3) * 16 + (v >> 4 & 15),
                        key.index.z * 64 + (number >> 4) * 16 + (v >> 8)});
        }
      }
    }
    return cells;
  }
  bool operator==(const Mirror&) const = default;

 private:
  std::map<BlockKey, std::map<int, ChunkBits>> blocks_;
};

VoxelMask mask_of(std::initializer_list<int> locals) {
  VoxelMask mask{};
  for (const int local : locals) mask[static_cast<std::size_t>(local / 64)] |= std::uint64_t{1} << (local % 64);
  return mask;
}

void drain(ClientView& view, BlockStore& store, Mirror& mirror, std::size_t most = SIZE_MAX) {
  while (most-- > 0) {
    const std::vector<BlockKey> forgotten = view.take_forgotten();  // of one level
    for (const BlockKey& key : forgotten) mirror.forget(key);
    const auto due = view.nearest();
    if (!due && forgotten.empty()) return;
    if (!due) continue;
    mirror.take(*store.frame(due->key, due->since));
    view.sent(store, due->key);
  }
}

ViewRegion all(int levels) {
  return {Eigen::Vector3d::Zero(), std::vector<double>(static_cast<std::size_t>(levels), 1e6), {}, 0.05};
}

/// A random change: few places, so that bricks share chunks, blocks and parents, and empty again.
std::pair<BrickIndex, VoxelMask> random_change() {
  const BrickIndex index{*rc::gen::inRange(-9, 9), *rc::gen::inRange(-9, 9), *rc::gen::inRange(-2, 2)};
  const int kind = *rc::gen::inRange(0, 3);
  if (kind == 0) return {index, {}};
  return {index, mask_of({*rc::gen::inRange(0, 512), *rc::gen::inRange(0, 512)})};
}

RC_GTEST_PROP(BlockStore, EachLevelHoldsTheCellsWithAnyVoxel, ()) {
  BlockStore store(0, kLevels);
  std::map<BrickIndex, VoxelMask> truth;
  std::vector<BlockKey> changed;
  const int changes = *rc::gen::inRange(1, 60);
  for (int i = 0; i < changes; ++i) {
    const auto [index, mask] = random_change();
    truth[index] = mask;
    store.set(index, mask, i + 1, changed);
  }
  for (int level = 0; level < kLevels; ++level) {
    std::set<VoxelIndex> expected;
    for (const auto& [index, mask] : truth) {
      for (int local = 0; local < kBrickVoxels; ++local) {
        if ((mask[static_cast<std::size_t>(local / 64)] >> (local % 64) & 1) == 0) continue;
        const VoxelIndex voxel = voxel_at(index, local);
        expected.insert({voxel.x >> level, voxel.y >> level, voxel.z >> level});
      }
    }
    Mirror mirror;
    ViewRegion region = all(level + 1);
    std::fill(region.radii.begin(), region.radii.end() - 1, 0.0);
    ClientView view(store, region);
    drain(view, store, mirror);
    RC_ASSERT(mirror.cells(level) == expected);
  }
}

RC_GTEST_PROP(ClientView, WhoeverReadsSlowlyAndLooksAroundEndsWithWhatIsThere, ()) {
  BlockStore store(0, 3);
  std::vector<BlockKey> changed;
  const auto random_region = [] {
    const double a = *rc::gen::inRange(0, 80) / 10.0, b = a + *rc::gen::inRange(0, 80) / 10.0,
                 c = b + *rc::gen::inRange(0, 200) / 10.0;
    return ViewRegion{{*rc::gen::inRange(-40, 40) / 10.0, *rc::gen::inRange(-40, 40) / 10.0, 0}, {a, b, c}, {}, 0.05};
  };
  ClientView view(store, random_region());
  Mirror mirror;
  std::int64_t revision = 0;
  const auto tell = [&] {
    for (const BlockKey& key : changed) view.changed(store, key);
    changed.clear();
  };
  const int steps = *rc::gen::inRange(1, 40);
  for (int i = 0; i < steps; ++i) {
    const int what = *rc::gen::inRange(0, 12);
    if (what < 2) {
      view.look(store, random_region());
    } else if (what < 7) {
      const auto [index, mask] = random_change();
      store.set(index, mask, ++revision, changed);
    } else if (what < 9) {
      tell();
    } else {
      drain(view, store, mirror, static_cast<std::size_t>(*rc::gen::inRange(0, 3)));
    }
  }
  tell();
  drain(view, store, mirror);
  RC_ASSERT(view.complete());

  Mirror fresh;
  ClientView late(store, view.region());
  drain(late, store, fresh);
  RC_ASSERT(mirror == fresh);
}

RC_GTEST_PROP(ClientView, WhoComesBackGetsJustWhatChanged, ()) {
  BlockStore store(0, 2);
  std::vector<BlockKey> changed;
  std::int64_t revision = 0;
  const auto change = [&](int times) {
    for (int i = 0; i < times; ++i) {
      const auto [index, mask] = random_change();
      store.set(index, mask, ++revision, changed);
    }
  };
  const ViewRegion region{Eigen::Vector3d::Zero(), {4.0, 1000.0}, {}, 0.05};
  change(*rc::gen::inRange(1, 30));
  Mirror mirror;
  ClientView before(store, region);
  drain(before, store, mirror);
  const std::int64_t known = revision;

  changed.clear();
  change(*rc::gen::inRange(0, 10));
  // What is empty is forgotten at times: who has the layer as of before that begins anew.
  if (*rc::gen::arbitrary<bool>()) {
    for (const BlockKey& key : store.emptied_before(revision + 1)) store.drop(key);
  }
  const bool goes_on = store.dropped() <= known;
  if (!goes_on) mirror = Mirror();
  ClientView after = goes_on ? ClientView(store, region, known) : ClientView(store, region);
  RC_ASSERT(!goes_on || after.lacking() <= std::set<BlockKey>(changed.begin(), changed.end()).size());
  drain(after, store, mirror);
  Mirror fresh;
  ClientView late(store, region);
  drain(late, store, fresh);
  RC_ASSERT(mirror == fresh);
}

RC_GTEST_PROP(ViewRegion, EveryPointIsShownOnceAtMostAndWithinReachAlways, ()) {
  const double a = *rc::gen::inRange(0, 100) / 10.0, b = a + *rc::gen::inRange(0, 100) / 10.0,
               c = b + *rc::gen::inRange(1, 300) / 10.0;
  const auto coordinate = [] { return *rc::gen::inRange(-4000, 4000) / 100.0 + 0.0013; };
  const ViewRegion region{{coordinate(), coordinate(), coordinate()}, {a, b, c}, {}, 0.05};
  const Eigen::Vector3d p{coordinate(), coordinate(), coordinate()};
  int shown = 0;
  for (int level = 0; level < 3; ++level) {
    const VoxelIndex block = voxel_of(p, 0.05 * 64 * (1 << level));
    if (in_view(region, {level, {block.x, block.y, block.z}})) ++shown;
  }
  RC_ASSERT(shown <= 1);
  if ((p - region.centre).norm() < c) RC_ASSERT(shown == 1);
}

TEST(BlockStore, AFrameIsMadeOnceForAllWhoLackTheSame) {
  BlockStore store(0, 1);
  std::vector<BlockKey> changed;
  store.set({0, 0, 0}, mask_of({1}), 1, changed);
  EXPECT_EQ(store.frame({0, {0, 0, 0}}, 0), store.frame({0, {0, 0, 0}}, 0));
  store.set({2, 0, 0}, mask_of({1}), 2, changed);
  const auto change = store.frame({0, {0, 0, 0}}, 1);
  EXPECT_EQ(change, store.frame({0, {0, 0, 0}}, 1));
  EXPECT_EQ(std::popcount(read_block(read_frame(*change).value()).value().told), 1) << "just the chunk that changed";
}

TEST(ClientView, TheNearestBlockComesFirst) {
  BlockStore store(0, 1);
  std::vector<BlockKey> changed;
  for (int x : {40, 8, 24, 0}) store.set({x, 0, 0}, mask_of({0}), 1, changed);
  ClientView view(store, {{-1, 0, 0}, {1000}, {}, 0.05});
  std::vector<int> order;
  while (const auto due = view.nearest()) {
    order.push_back(due->key.index.x);
    view.sent(store, due->key);
  }
  EXPECT_EQ(order, (std::vector<int>{0, 1, 3, 5}));
}

TEST(ClientView, ABlockThatWasSentBeforeItsChangeWasToldIsNotSentAgain) {
  BlockStore store(0, 1);
  std::vector<BlockKey> changed;
  store.set({0, 0, 0}, mask_of({0}), 1, changed);
  ClientView view(store, all(1));  // looks between the change and the telling of it
  view.sent(store, view.nearest().value().key);
  for (const BlockKey& key : changed) view.changed(store, key);
  EXPECT_TRUE(view.complete());
  changed.clear();
  store.set({0, 0, 0}, mask_of({1}), 2, changed);
  for (const BlockKey& key : changed) view.changed(store, key);
  ASSERT_TRUE(view.nearest());
  EXPECT_EQ(view.nearest()->since, 1);
}

TEST(ClientView, OnlyTheNewestStateIsSentAndTheOthersAreCounted) {
  BlockStore store(0, 1);
  ClientView view(store, all(1));
  std::vector<BlockKey> changed;
  for (int i = 0; i < 5; ++i) {
    changed.clear();
    store.set({0, 0, 0}, mask_of({i}), i + 1, changed);
    for (const BlockKey& key : changed) view.changed(store, key);
  }
  EXPECT_EQ(view.lacking(), 1u);
  EXPECT_EQ(view.skipped(), 4);
}

}  // namespace
}  // namespace concord::hmd
