#include "core/alignment.hpp"

namespace concord {
namespace {

constexpr AlignReason kReasons[] = {AlignReason::kAccepted, AlignReason::kNoMap,      AlignReason::kLowOverlap,
                                    AlignReason::kDiverged, AlignReason::kDegenerate, AlignReason::kAmbiguous};

}  // namespace

const char* name(AlignReason reason) {
  switch (reason) {
    case AlignReason::kAccepted: return "ACCEPTED";
    case AlignReason::kNoMap: return "NO_MAP";
    case AlignReason::kLowOverlap: return "LOW_OVERLAP";
    case AlignReason::kDiverged: return "DIVERGED";
    case AlignReason::kDegenerate: return "DEGENERATE";
    case AlignReason::kAmbiguous: return "AMBIGUOUS";
  }
  return "?";
}

std::optional<AlignReason> align_reason(std::string_view text) {
  for (const AlignReason reason : kReasons) {
    if (text == name(reason)) return reason;
  }
  return std::nullopt;
}

}  // namespace concord
