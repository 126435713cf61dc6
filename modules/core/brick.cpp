#include "core/brick.hpp"

#include <algorithm>
#include <cassert>

#include "core/brick_kernels.hpp"

namespace concord {
namespace {

int count_bits(const VoxelMask& mask) { return brick_kernels().count(mask); }

}  // namespace

Brick::Brick(const Brick& other) : known_(other.known_), count_(other.count_), value_(other.value_) {
  if (other.values_ != nullptr) {
    values_ = std::make_unique_for_overwrite<LogOdds[]>(count_);
    std::copy_n(other.values_.get(), count_, values_.get());
  }
}

Brick& Brick::operator=(const Brick& other) {
  if (this != &other) *this = Brick(other);
  return *this;
}

Brick Brick::from_dense(const DenseBrick& dense) {
  KeyBrick keys;
  for (int local = 0; local < kBrickVoxels; ++local) keys[local] = key_of(dense[local]);
  return pack(keys.data());
}

Brick Brick::uniform(const VoxelMask& known, LogOdds value) {
  assert(is_known(value));
  Brick brick;
  brick.known_ = known;
  brick.count_ = static_cast<std::uint16_t>(count_bits(known));
  if (brick.count_ != 0) brick.value_ = value;
  return brick;
}

Brick Brick::from_packed(const VoxelMask& known, std::span<const LogOdds> values) {
  assert(static_cast<std::size_t>(count_bits(known)) == values.size());
  if (values.empty()) return {};
  if (std::equal(values.begin() + 1, values.end(), values.begin())) {  // each equals the one before it
    return uniform(known, values.front());
  }
  Brick brick;
  brick.known_ = known;
  brick.count_ = static_cast<std::uint16_t>(values.size());
  brick.values_ = std::make_unique_for_overwrite<LogOdds[]>(values.size());
  std::copy(values.begin(), values.end(), brick.values_.get());
  return brick;
}

void Brick::to_dense(DenseBrick& out) const {
  KeyBrick keys;
  expand(*this, keys.data());
  for (int local = 0; local < kBrickVoxels; ++local) out[local] = log_odds_of(keys[local]);
}

LogOdds Brick::at(int local) const {
  const int word = local / 64;
  const std::uint64_t bit = std::uint64_t{1} << (local % 64);
  if ((known_[word] & bit) == 0) return kUnknown;
  if (values_ == nullptr) return value_;
  int rank = std::popcount(known_[word] & (bit - 1));
  for (int w = 0; w < word; ++w) rank += std::popcount(known_[w]);
  return values_[rank];
}

VoxelMask Brick::occupied() const {
  if (is_uniform()) return is_occupied(value_) ? known_ : VoxelMask{};
  KeyBrick keys;
  return expand(*this, keys.data());
}

int Brick::occupied_count() const { return count_bits(occupied()); }

bool Brick::operator==(const Brick& other) const {
  return known_ == other.known_ && value_ == other.value_ && is_uniform() == other.is_uniform() &&
         (is_uniform() || std::equal(packed().begin(), packed().end(), other.packed().begin()));
}

}  // namespace concord
