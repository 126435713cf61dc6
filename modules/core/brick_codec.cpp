#include "core/brick_codec.hpp"

#include <algorithm>
#include <bit>
#include <cassert>

namespace concord {
namespace {

enum class Values : std::uint8_t { kEmpty, kUniform, kPair, kPalette, kRaw };
enum class Mask : std::uint8_t { kAll, kSparse, kFull };

constexpr std::size_t kMaxPalette = 256;
constexpr std::size_t kMaskBytes = kBrickVoxels / 8;

std::uint8_t tag_of(Values values, Mask mask) {
  return static_cast<std::uint8_t>(static_cast<unsigned>(values) | static_cast<unsigned>(mask) << 3);
}

/// The distinct values of a brick, ascending. `size` is 0 when there are more than a palette holds.
struct Palette {
  std::array<LogOdds, kMaxPalette> values;
  std::size_t size = 0;

  [[nodiscard]] std::span<const LogOdds> span() const { return {values.data(), size}; }
};

Palette palette_of(std::span<const LogOdds> packed) {
  Palette palette;
  // Almost every brick of a binary map has two values: found without sorting.
  const LogOdds first = packed.front();
  const LogOdds second = *std::find_if(packed.begin(), packed.end(), [&](LogOdds l) { return l != first; });
  if (std::all_of(packed.begin(), packed.end(), [&](LogOdds l) { return l == first || l == second; })) {
    palette.values[0] = std::min(first, second);
    palette.values[1] = std::max(first, second);
    palette.size = 2;
    return palette;
  }
  DenseBrick sorted;
  const auto end = std::copy(packed.begin(), packed.end(), sorted.begin());
  std::sort(sorted.begin(), end);
  const auto size = static_cast<std::size_t>(std::unique(sorted.begin(), end) - sorted.begin());
  if (size > kMaxPalette) return palette;
  std::copy_n(sorted.begin(), size, palette.values.begin());
  palette.size = size;
  return palette;
}

std::size_t index_bits(std::size_t palette_size) { return static_cast<std::size_t>(std::bit_width(palette_size - 1)); }

std::size_t index_bytes(std::size_t palette_size, std::size_t voxels) {
  return (voxels * index_bits(palette_size) + 7) / 8;
}

Values values_form(const Brick& brick, const Palette& palette) {
  if (brick.empty()) return Values::kEmpty;
  if (brick.is_uniform()) return Values::kUniform;
  if (palette.size == 0) return Values::kRaw;
  const std::size_t voxels = brick.packed().size();
  const std::size_t count_byte = palette.size == 2 ? 0 : 1;
  if (count_byte + 2 * palette.size + index_bytes(palette.size, voxels) >= 2 * voxels) return Values::kRaw;
  return palette.size == 2 ? Values::kPair : Values::kPalette;
}

std::uint8_t mask_byte(const VoxelMask& mask, std::size_t i) {
  return static_cast<std::uint8_t>(mask[i / 8] >> (8 * (i % 8)));
}

std::uint64_t used_bytes(const VoxelMask& mask) {
  std::uint64_t used = 0;
  for (std::size_t i = 0; i < kMaskBytes; ++i) used |= std::uint64_t{mask_byte(mask, i) != 0} << i;
  return used;
}

Mask mask_form(const Brick& brick, std::uint64_t used) {
  if (brick.known_count() == kBrickVoxels || brick.empty()) return Mask::kAll;
  return 8 + static_cast<std::size_t>(std::popcount(used)) < kMaskBytes ? Mask::kSparse : Mask::kFull;
}

void append_mask(Bytes& out, Mask form, const VoxelMask& mask, std::uint64_t used) {
  if (form == Mask::kAll) return;
  if (form == Mask::kSparse) append_le(out, used);
  for (std::size_t i = 0; i < kMaskBytes; ++i) {
    if (form == Mask::kFull || (used >> i & 1) != 0) out.push_back(mask_byte(mask, i));
  }
}

/// One bit a voxel: whether it holds the higher of two values. Almost every brick of a binary map goes this way.
void append_pair_indices(Bytes& out, std::span<const LogOdds> packed, LogOdds higher) {
  for (std::size_t begin = 0; begin < packed.size(); begin += 8) {
    const std::size_t count = std::min<std::size_t>(8, packed.size() - begin);
    unsigned byte = 0;
    for (std::size_t i = 0; i < count; ++i) byte |= static_cast<unsigned>(packed[begin + i] == higher) << i;
    out.push_back(static_cast<std::uint8_t>(byte));
  }
}

void append_indices(Bytes& out, std::span<const LogOdds> packed, const Palette& palette) {
  if (palette.size == 2) return append_pair_indices(out, packed, palette.values[1]);
  const std::size_t bits = index_bits(palette.size);
  std::uint32_t pending = 0;
  std::size_t pending_bits = 0;
  for (const LogOdds l : packed) {
    const auto found = std::lower_bound(palette.values.begin(), palette.values.begin() + palette.size, l);
    pending |= static_cast<std::uint32_t>(found - palette.values.begin()) << pending_bits;
    pending_bits += bits;
    for (; pending_bits >= 8; pending_bits -= 8, pending >>= 8) out.push_back(static_cast<std::uint8_t>(pending));
  }
  if (pending_bits > 0) out.push_back(static_cast<std::uint8_t>(pending));
}

tl::unexpected<Error> malformed() {
  return refuse(Code::kMalformed, "bytes that are no brick; sender and receiver may be of different versions");
}

/// Takes `count` values off `in`; false when it ends early or one of them is no value.
bool take_values(ByteSpan& in, std::size_t count, LogOdds* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<LogOdds> value = read_le<LogOdds>(in);
    if (!value || !is_known(*value)) return false;
    out[i] = *value;
  }
  return true;
}

bool take_mask(ByteSpan& in, Mask form, VoxelMask& mask) {
  std::uint64_t used = ~std::uint64_t{0};
  if (form == Mask::kAll) {
    mask.fill(used);
    return true;
  }
  if (form == Mask::kSparse) {
    const auto read = read_le<std::uint64_t>(in);
    if (!read) return false;
    used = *read;
  }
  if (in.size() < static_cast<std::size_t>(std::popcount(used))) return false;
  mask = {};
  for (std::uint64_t rest = used; rest != 0; rest &= rest - 1) {
    const int i = std::countr_zero(rest);
    mask[i / 8] |= std::uint64_t{in.front()} << (8 * (i % 8));
    in = in.subspan(1);
  }
  return true;
}

bool take_indexed(ByteSpan& in, std::size_t palette_size, std::size_t voxels, LogOdds* out) {
  std::array<LogOdds, kMaxPalette> palette;
  if (!take_values(in, palette_size, palette.data())) return false;
  const std::size_t bytes = index_bytes(palette_size, voxels);
  if (in.size() < bytes) return false;
  const std::size_t bits = index_bits(palette_size);
  for (std::size_t i = 0; i < voxels; ++i) {
    const std::size_t at = i * bits;
    const std::uint32_t high = at / 8 + 1 < bytes ? in[at / 8 + 1] : 0;
    const std::size_t index = ((in[at / 8] | high << 8) >> (at % 8)) & ((1u << bits) - 1);
    if (index >= palette_size) return false;
    out[i] = palette[index];
  }
  in = in.subspan(bytes);
  return true;
}

/// What the bytes say, whether or not they say it in the shortest form.
Result<Brick> decode(ByteSpan& in) {
  const std::optional<std::uint8_t> tag = read_le<std::uint8_t>(in);
  if (!tag || (*tag & 7) > static_cast<unsigned>(Values::kRaw) || *tag >> 3 > static_cast<unsigned>(Mask::kFull)) {
    return malformed();
  }
  const auto form = static_cast<Values>(*tag & 7);
  if (form == Values::kEmpty) return Brick();

  VoxelMask known;
  if (!take_mask(in, static_cast<Mask>(*tag >> 3), known)) return malformed();
  std::size_t voxels = 0;
  for (const std::uint64_t word : known) voxels += static_cast<std::size_t>(std::popcount(word));
  if (voxels == 0) return malformed();

  DenseBrick values;
  switch (form) {
    case Values::kEmpty: break;
    case Values::kUniform:
      if (!take_values(in, 1, values.data())) return malformed();
      return Brick::uniform(known, values[0]);
    case Values::kPair:
      if (!take_indexed(in, 2, voxels, values.data())) return malformed();
      break;
    case Values::kPalette: {
      const std::optional<std::uint8_t> last = read_le<std::uint8_t>(in);
      if (!last || *last < 2 || !take_indexed(in, *last + 1u, voxels, values.data())) return malformed();
      break;
    }
    case Values::kRaw:
      if (!take_values(in, voxels, values.data())) return malformed();
      break;
  }
  return Brick::from_packed(known, {values.data(), voxels});
}

}  // namespace

void append_brick(Bytes& out, const Brick& brick) {
  const Palette palette = brick.is_uniform() ? Palette{} : palette_of(brick.packed());
  const Values form = values_form(brick, palette);
  const std::uint64_t used = used_bytes(brick.known());
  const Mask mask = mask_form(brick, used);
  out.push_back(tag_of(form, mask));
  if (form == Values::kEmpty) return;
  append_mask(out, mask, brick.known(), used);
  switch (form) {
    case Values::kEmpty: break;
    case Values::kUniform: append_le(out, brick.uniform_value()); break;
    case Values::kPalette: out.push_back(static_cast<std::uint8_t>(palette.size - 1)); [[fallthrough]];
    case Values::kPair:
      for (const LogOdds l : palette.span()) append_le(out, l);
      append_indices(out, brick.packed(), palette);
      break;
    case Values::kRaw:
      for (const LogOdds l : brick.packed()) append_le(out, l);
      break;
  }
}

Result<Brick> read_brick(ByteSpan& in) {
  ByteSpan rest = in;
  Result<Brick> brick = decode(rest);
  if (!brick) return brick;
  // Strict in one stroke: what is not our own encoding of this very brick is refused.
  Bytes canonical;
  canonical.reserve(kMaxBrickBytes);
  append_brick(canonical, *brick);
  if (!std::equal(canonical.begin(), canonical.end(), in.begin(), in.begin() + (in.size() - rest.size()))) {
    return malformed();
  }
  in = rest;
  return brick;
}

}  // namespace concord
