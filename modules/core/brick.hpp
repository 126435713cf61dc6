#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>

#include "core/lattice.hpp"
#include "core/log_odds.hpp"

namespace concord {

/// One bit per voxel of a brick, bit `local % 64` of word `local / 64`.
using VoxelMask = std::array<std::uint64_t, 8>;

/// A brick with one value per voxel, unknown ones included: what algorithms work on.
using DenseBrick = std::array<LogOdds, kBrickVoxels>;

/// A brick as it is kept: a mask of the known voxels and their values, packed in voxel order;
/// a single value where all known voxels agree. Equal content has equal representation.
class Brick {
 public:
  Brick() = default;
  Brick(const Brick& other);
  Brick& operator=(const Brick& other);
  Brick(Brick&&) noexcept = default;
  Brick& operator=(Brick&&) noexcept = default;
  ~Brick() = default;

  [[nodiscard]] static Brick from_dense(const DenseBrick& dense);
  /// Every voxel of `known` has `value`. @pre is_known(value).
  [[nodiscard]] static Brick uniform(const VoxelMask& known, LogOdds value);
  /// @pre `values` holds one known value per bit of `known`, in voxel order.
  [[nodiscard]] static Brick from_packed(const VoxelMask& known, std::span<const LogOdds> values);

  void to_dense(DenseBrick& out) const;
  [[nodiscard]] LogOdds at(int local) const;

  [[nodiscard]] const VoxelMask& known() const { return known_; }
  [[nodiscard]] int known_count() const { return count_; }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] bool is_uniform() const { return values_ == nullptr; }
  /// @pre is_uniform() and not empty().
  [[nodiscard]] LogOdds uniform_value() const { return value_; }
  /// @pre not is_uniform().
  [[nodiscard]] std::span<const LogOdds> packed() const { return {values_.get(), count_}; }
  [[nodiscard]] VoxelMask occupied() const;
  [[nodiscard]] int occupied_count() const;

  /// Calls `visit(local, value)` for each known voxel, in voxel order.
  template <class Visit>
  void for_each(Visit&& visit) const {
    const LogOdds* value = values_.get();
    for (int word = 0; word < 8; ++word) {
      for (std::uint64_t bits = known_[word]; bits != 0; bits &= bits - 1) {
        visit(word * 64 + std::countr_zero(bits), value != nullptr ? *value++ : value_);
      }
    }
  }

  bool operator==(const Brick& other) const;

 private:
  VoxelMask known_{};
  std::unique_ptr<LogOdds[]> values_;  // null when uniform
  std::uint16_t count_ = 0;
  LogOdds value_ = kUnknown;
};

}  // namespace concord
