#pragma once

#include <cstdint>
#include <string>

#include "core/corrections.hpp"
#include "core/transform.hpp"

namespace concord {

inline constexpr std::size_t kMaxThings = 1000;

/// Somebody saw an object of which there is a model.
struct Detection {
  std::string id;
  std::string author;  ///< who saw it
  std::string asset;   ///< its name, or that of a class that one asset alone has
  std::string object;  ///< what they call this very object, if they follow it; else empty
  double score = 0.0;  ///< 0 to 1
  Transform T_frame_asset = Transform::Identity();
  WorkFrame frame;
  std::int64_t utime = 0;  ///< when it was seen
};

/// A person's word on it.
struct DetectionDecision {
  enum class Op { kConfirm, kDrop };
  std::string id;  ///< at most kMostAssetId bytes; with kConfirm that of the injection
  std::string author;
  Op op = Op::kConfirm;
  std::int64_t thing = 0;  ///< its number
  std::int64_t utime = 0;
};

/// An object that was seen, once or again and again.
struct Thing {
  std::int64_t number = 0;  ///< from 1
  std::string asset;
  std::string class_name;
  double score = 0.0;  ///< of the best sighting
  std::int32_t sightings = 0;
  std::int64_t last_seen = 0;
  std::string author;  ///< who saw it last
  Transform T_map_asset = Transform::Identity();
  std::string injection;  ///< the request that injected it; empty: nobody has confirmed it
};

}  // namespace concord
