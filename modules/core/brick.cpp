#include "core/brick.hpp"

#include <algorithm>
#include <cassert>

namespace concord {
namespace {

int count_bits(const VoxelMask& mask) {
  int count = 0;
  for (const std::uint64_t word : mask) count += std::popcount(word);
  return count;
}

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
  VoxelMask known{};
  DenseBrick packed;
  std::size_t count = 0;
  for (int local = 0; local < kBrickVoxels; ++local) {
    const LogOdds l = dense[local];
    known[local / 64] |= std::uint64_t{is_known(l)} << (local % 64);
    packed[count] = l;
    count += is_known(l);
  }
  return from_packed(known, {packed.data(), count});
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
  if (std::all_of(values.begin(), values.end(), [&](LogOdds l) { return l == values.front(); })) {
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
  out.fill(kUnknown);
  for_each([&](int local, LogOdds l) { out[local] = l; });
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
  VoxelMask mask{};
  for_each([&](int local, LogOdds l) { mask[local / 64] |= std::uint64_t{is_occupied(l)} << (local % 64); });
  return mask;
}

int Brick::occupied_count() const { return count_bits(occupied()); }

bool Brick::operator==(const Brick& other) const {
  return known_ == other.known_ && value_ == other.value_ && is_uniform() == other.is_uniform() &&
         (is_uniform() || std::equal(packed().begin(), packed().end(), other.packed().begin()));
}

}  // namespace concord
