#pragma once

#include <cstdint>
#include <string>

#include "core/agent_layer.hpp"
#include "core/byte_stream.hpp"
#include "core/corrections.hpp"
#include "core/error.hpp"
#include "core/requests.hpp"

namespace concord {

/// The first pair in the map, which is placed in two halves: the target, which makes the map's frame, then the source.
/// Once begun it is brought to an end, whoever goes away meanwhile: both lie in the map, or the target is taken out.
struct MapFounding {
  std::string align_id;
  std::int64_t utime = 0;   ///< when that was found
  TransformRequest target;  ///< at the identity
  TransformRequest source;  ///< as the decision asks
  bool is_undone = false;   ///< merge refused the second half, or people dropped it

  [[nodiscard]] std::string taking_back_id() const { return target.id + "-"; }
};

/// What merge is to be asked next; again and again, as messages are lost.
enum class FoundingStep {
  kWait,
  kPlaceTarget,
  kPlaceSource,
  kTakeBack,  ///< the target, see take_back; until merge answers that
  kOver,      ///< the source is in the map
};
/// `is_founded`: somebody is in the map, with or without a submap. `open_for`: microseconds in which the target must
/// have come to lie there, since `utime`.
[[nodiscard]] FoundingStep next_step(const MapFounding& founding, const AgentLayers& layers, bool is_founded,
                                     std::int64_t now, std::int64_t open_for);

/// The id of the placement that founds the map, before the one of this decision.
[[nodiscard]] std::string founding_id(const std::string& decision_id);
[[nodiscard]] UndoRequest take_back(const MapFounding& founding, std::int64_t now);

/// To be kept over a restart, bit by bit: merge knows a request by its content.
[[nodiscard]] Bytes to_bytes(const MapFounding& founding);
/// Refused (kMalformed): it is none.
[[nodiscard]] Result<MapFounding> founding_of(ByteSpan bytes);
inline constexpr std::size_t kMaxFoundingBytes = 4096;

}  // namespace concord
