#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "bus/messages.hpp"
#include "bus/translate.hpp"

namespace concord::wire {

/// Of a part of a list: fingerprint, utime, content, part, parts, count.
inline constexpr std::size_t kBeforeItems = 8 + 8 + 8 + 4 + 4 + 4;

/// `items`: which member of the message holds them.
template <class Lcm, class Item, class T>
[[nodiscard]] Bytes write_list(const ListPart<T>& value, std::int64_t utime, std::vector<Item> Lcm::*items,
                               Item (*to_wire)(const T&)) {
  Lcm out;
  out.utime = utime;
  out.content = static_cast<std::int64_t>(value.content);
  out.part = value.part;
  out.parts = value.parts;
  out.count = static_cast<std::int32_t>(value.items.size());
  for (const T& item : value.items) (out.*items).push_back(to_wire(item));
  return to_bytes(out);
}

/// `item`: the layout of one; `most_parts`: that a list of its kind may have.
template <class T, class Lcm, class Item>
[[nodiscard]] Decoded<ListPart<T>> read_list(std::span<const std::uint8_t> bytes, std::vector<Item> Lcm::*items,
                                             std::span<const WireField> item, std::int64_t most_parts,
                                             Decoded<T> (*from_wire)(const Item&)) {
  const WireField layout[] = {fixed(8 + 8 + 4 + 4), count(kMostInPart), records(item)};
  const auto in = from_bytes<Lcm>(bytes, layout);
  if (!in) return bad(in.error());
  if (auto fine = check_part(in->part, in->parts, most_parts); !fine) return bad(fine.error());
  ListPart<T> out{static_cast<std::uint64_t>(in->content), in->part, in->parts, {}, {}};
  for (const Item& one : (*in).*items) {
    auto value = from_wire(one);
    if (!value) return tl::unexpected(value.error());
    out.items.push_back(std::move(*value));
  }
  const auto encoded = bytes.subspan(kBeforeItems);
  out.encoded.assign(encoded.begin(), encoded.end());
  return out;
}

}  // namespace concord::wire
