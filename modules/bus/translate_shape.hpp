#pragma once

// Private to the translators: shapes and zones on the wire.

#include <concord/shape_t.hpp>
#include <concord/zone_t.hpp>

#include "bus/translate.hpp"
#include "core/corrections.hpp"

namespace concord::wire {

/// What shape_t may hold, where it selects up to so many boxes of voxels and has up to so many corners.
template <std::int64_t kMostBoxes, std::int64_t kMostPoints>
inline constexpr WireField kShapeOf[] = {
    fixed(1 + 8), count(kMostBoxes), array(4),           array(4), array(4), array(4), array(4),
    array(4),     fixed(8 + 8 + 8),  count(kMostPoints), array(8), array(8), array(8), fixed(kTransformBytes)};

/// In requests, also where a volume is wanted: what is no volume is then refused to its asker.
inline constexpr WireField kShape = record(kShapeOf<kMaxSelectionBoxes, kMaxShapePoints>);
inline constexpr WireField kVolume = record(kShapeOf<0, kMaxVolumePoints>);

[[nodiscard]] shape_t to_wire(const Shape& shape);
[[nodiscard]] shape_t to_wire(const Volume& volume);

/// Refused: a kind that is none or has not the corners it should (kBadShape), and what core's `check` refuses.
[[nodiscard]] Result<Shape> shape_from_wire(const shape_t& in);
/// Refused also: what is no volume (kBadShape), or has over kMaxVolumePoints corners (kTooLarge).
[[nodiscard]] Result<Volume> volume_from_wire(const shape_t& in);

inline constexpr std::int64_t kTitleLength = kMaxTitleBytes;  ///< see is_title

/// Of a new zone.
[[nodiscard]] Result<std::string> title_of(const std::string& name);
/// Of one that there is, made when names were taken that are not any more.
[[nodiscard]] Result<std::string> kept_title_of(const std::string& name);
[[nodiscard]] std::int8_t to_wire(Zone::Kind kind);
[[nodiscard]] Result<Zone::Kind> zone_kind(std::int8_t kind);
/// Of a zone or what asks for one, checked together with its cost.
template <class Message>
[[nodiscard]] Result<double> margin_of(const Message& in) {
  return zone_kind(in.kind).and_then([&](Zone::Kind kind) { return check_terms(kind, in.margin, in.cost); }).map([&] {
    return in.margin;
  });
}

}  // namespace concord::wire
