#include "core/brick_kernels.hpp"

#include <random>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "core/lattice_transform.hpp"

namespace concord {
namespace {

KeyBrick random_keys(std::mt19937& random, int density) {
  KeyBrick keys;
  for (Key& key : keys) {
    const bool is_known = static_cast<int>(random() % 100) < density;
    key = is_known ? static_cast<Key>(random() % 65535 + 1) : Key{0};
  }
  return keys;
}

struct Packed {
  VoxelMask known{};
  std::vector<LogOdds> values;
  bool operator==(const Packed&) const = default;
};

Packed pack(const BrickKernels& kernels, const KeyBrick& keys) {
  Packed out;
  std::array<LogOdds, kBrickVoxels + 8> values;
  const int count = kernels.pack(keys.data(), out.known, values.data());
  out.values.assign(values.begin(), values.begin() + count);
  return out;
}

TEST(Kernels, PackAndExpandAreInverseOnAnyMachine) {
  EXPECT_TRUE(rc::check([](std::uint32_t seed) {
    std::mt19937 random(seed);
    const KeyBrick keys = random_keys(random, *rc::gen::inRange(0, 101));
    const Packed packed = pack(brick_kernels(), keys);
    RC_ASSERT(packed == pack(portable_kernels(), keys));
    RC_ASSERT(brick_kernels().count(packed.known) == static_cast<int>(packed.values.size()));
    for (const BrickKernels* kernels : {&brick_kernels(), &portable_kernels()}) {
      KeyBrick back;
      // On the heap, of the exact size: reading past the end is an error that a sanitizer sees.
      const std::vector<LogOdds> values = packed.values;
      const VoxelMask occupied = kernels->expand(packed.known, values.data(), false, back.data(), 8, 64);
      RC_ASSERT(back == keys);
      for (int i = 0; i < kBrickVoxels; ++i) {
        RC_ASSERT((occupied[i / 64] >> (i % 64) & 1) == (is_occupied(log_odds_of(keys[i])) ? 1U : 0U));
      }
    }
  }));
}

TEST(Kernels, ExpandOneValue) {
  for (const BrickKernels* kernels : {&brick_kernels(), &portable_kernels()}) {
    for (const LogOdds value : {kFree, kOccupied}) {
      VoxelMask known{};
      known[3] = 0x8000000000000001;
      known[7] = 0xF0;
      KeyBrick keys;
      const VoxelMask occupied = kernels->expand(known, &value, true, keys.data(), 8, 64);
      EXPECT_EQ(occupied, value == kOccupied ? known : VoxelMask{});
      for (int i = 0; i < kBrickVoxels; ++i) {
        EXPECT_EQ(keys[i], (known[i / 64] >> (i % 64) & 1) != 0 ? key_of(value) : 0);
      }
    }
  }
}

TEST(Kernels, FoldTheSameOnAnyMachine) {
  EXPECT_TRUE(rc::check([](std::uint32_t seed) {
    std::mt19937 random(seed);
    const int count = *rc::gen::inRange(1, 90);
    std::vector<KeyBrick> bricks;
    std::vector<const Key*> pointers;
    std::vector<std::int32_t> weights;
    for (int i = 0; i < count; ++i) bricks.push_back(random_keys(random, 60));
    for (int i = 0; i < count; ++i) {
      pointers.push_back(bricks[i].data());
      weights.push_back(static_cast<std::int32_t>(random() % 1000 + 1));
    }
    std::array<KeyBrick, 2> out;
    std::array<VoxelMask, 2> conflicts;
    brick_kernels().mean(pointers.data(), weights.data(), count, out[0].data(), conflicts[0]);
    portable_kernels().mean(pointers.data(), weights.data(), count, out[1].data(), conflicts[1]);
    RC_ASSERT(out[0] == out[1]);
    RC_ASSERT(conflicts[0] == conflicts[1]);
    brick_kernels().table(pointers.data(), count, out[0].data(), conflicts[0]);
    portable_kernels().table(pointers.data(), count, out[1].data(), conflicts[1]);
    RC_ASSERT(out[0] == out[1]);
    RC_ASSERT(conflicts[0] == conflicts[1]);
  }));
}

TEST(Kernels, PullTheSameOnAnyMachineAndSkipNothing) {
  EXPECT_TRUE(rc::check([](std::uint32_t seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    Transform T = Transform::Identity();
    T.linear() = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                     .normalized()
                     .toRotationMatrix();
    const LatticeTransform transform(T, 1.0);
    std::vector<Key> cells(SourceBox::kCells);
    std::vector<std::uint64_t> known(SourceBox::kNearRows);
    std::vector<std::uint64_t> near(SourceBox::kNearRows);
    for (int i = 0; i < 3000; ++i) {
      const int x = static_cast<int>(random() % 64);
      const int y = static_cast<int>(random() % 64);
      const int z = static_cast<int>(random() % 64);
      cells[x + y * SourceBox::kRow + z * SourceBox::kPlane] = static_cast<Key>(random() % 65535 + 1);
      known[SourceBox::near_row(y, z)] |= std::uint64_t{1} << x;
    }
    portable_kernels().widen(known.data(), near.data(), 0, SourceBox::kSide);
    std::vector<std::uint64_t> near_too(SourceBox::kNearRows);
    brick_kernels().widen(known.data(), near_too.data(), 0, SourceBox::kSide);
    RC_ASSERT(near == near_too);

    // A brick's corner may be 12.2 voxels from its middle.
    const PullSteps& steps = transform.pull_steps();
    const FixedPoint middle{32 << kFractionBits, (20 << kFractionBits) + 5, (44 << kFractionBits) - 77};
    FixedPoint origin;
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = middle[axis] - 7 * (steps.half[axis]);
    }
    std::array<KeyBrick, 2> out{};
    const bool found = brick_kernels().pull(cells.data(), near.data(), steps, origin, out[0].data());
    RC_ASSERT(found == portable_kernels().pull(cells.data(), near.data(), steps, origin, out[1].data()));
    RC_ASSERT(out[0] == out[1]);
    for (int i = 0; i < kBrickVoxels; ++i) {
      const VoxelIndex v = voxel_at({}, i);
      std::array<int, 3> cell;
      for (int axis = 0; axis < 3; ++axis) {
        const auto& s = transform.inverse_steps();
        cell[axis] = (origin[axis] + v.x * s[0][axis] + v.y * s[1][axis] + v.z * s[2][axis]) >> kFractionBits;
      }
      RC_ASSERT(out[0][i] == cells[cell[0] + cell[1] * SourceBox::kRow + cell[2] * SourceBox::kPlane]);
    }
  }));
}

}  // namespace
}  // namespace concord
