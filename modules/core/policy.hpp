#pragma once

namespace concord {

/// How layers that know a voxel become one value. Unknown never counts.
enum class Policy {
  kMean,  ///< SLAM-XR eq. 1 over log-odds: sum(w l) / sum(w); occupied if sum(w l) >= 0
  kTable  ///< HAC-SLAM eq. 1 and Table I: the largest
};

}  // namespace concord
