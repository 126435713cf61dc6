#pragma once

#include <string>
#include <vector>

#include "bus/list_stream.hpp"
#include "bus/messages.hpp"
#include "core/label_corrections.hpp"

namespace concord {

/// Messages about labels, as values: core/label_corrections.hpp and these.

/// A part of the answer to a LabelQuery, and what a LabelRequest led to.
struct LabelList {
  std::string id;  ///< the request's
  std::int32_t part = 0, parts = 1;
  std::vector<LabelInstance> instances;  ///< by ascending class and number
};
[[nodiscard]] std::vector<LabelList> in_parts(LabelList whole);

[[nodiscard]] Bytes encode(const LabelRequest& value);
[[nodiscard]] Bytes encode(const LabelQuery& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const LabelList& value, std::int64_t utime);
[[nodiscard]] Bytes encode(const ListPart<LabelSlot>& value, std::int64_t utime);

template <>
Decoded<LabelRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<LabelQuery> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<LabelList> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<ListPart<LabelSlot>> decode(std::span<const std::uint8_t> bytes);

template <>
inline constexpr std::size_t kMostItems<LabelSlot> = kMaxLabelSlots;
template <>
inline constexpr int kQueuedOf<LabelRequest> = 128;  ///< of up to 1.6 MB

}  // namespace concord
