#pragma once

#include "bus/list_stream.hpp"
#include "bus/messages.hpp"
#include "core/detections.hpp"

namespace concord {

[[nodiscard]] Bytes encode(const Detection& value);
[[nodiscard]] Bytes encode(const DetectionDecision& value);
[[nodiscard]] Bytes encode(const ListPart<Thing>& value, std::int64_t utime);

template <>
Decoded<Detection> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<DetectionDecision> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<ListPart<Thing>> decode(std::span<const std::uint8_t> bytes);

template <>
inline constexpr std::size_t kMostItems<Thing> = kMaxThings;

}  // namespace concord
