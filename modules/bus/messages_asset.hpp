#pragma once

#include "bus/list_stream.hpp"
#include "bus/messages.hpp"
#include "core/assets.hpp"

namespace concord {

[[nodiscard]] Bytes encode(const AssetRequest& value);
[[nodiscard]] Bytes encode(const ListPart<Asset>& value, std::int64_t utime);

template <>
Decoded<AssetRequest> decode(std::span<const std::uint8_t> bytes);
template <>
Decoded<ListPart<Asset>> decode(std::span<const std::uint8_t> bytes);

template <>
inline constexpr std::size_t kMostItems<Asset> = kMaxAssets;
template <>
inline constexpr int kQueuedOf<AssetRequest> = 64;  ///< each takes up to a minute

}  // namespace concord
