#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/detections.hpp"
#include "core/error.hpp"

namespace concord {

/// What was seen, made into things: repeated sightings of one object are one.
///
/// A sighting is of the thing that who saw it followed under the same name; else of the nearest one of the same asset
/// within kSameThing; else of a new one. Until a person confirms it, a thing lies where its sightings lie on average,
/// each by its score, the last ten counting. Confirmed, it stays where it was put until kAgreeing sightings in a row
/// agree that it is somewhere else.
class Sightings {
 public:
  static constexpr double kSameThing = 0.5;  ///< metres
  static constexpr double kMoved = 0.15;     ///< metres from where it was put
  static constexpr double kTurned = 0.5;     ///< radians
  static constexpr int kAgreeing = 3;

  struct Seen {
    std::int64_t number = 0;
    bool is_new = false;
    std::optional<Transform> moved_to;  ///< it was confirmed, and lies there now: it has to be moved
  };
  /// @param asset the one that was seen, whatever name the detection has for it. Refused (kTooLarge): one thing more
  /// than kMaxThings, all of which are confirmed; else the one that was not seen for the longest time gives way.
  [[nodiscard]] Result<Seen> see(const Detection& detection, const std::string& asset, const std::string& class_name,
                                 const Transform& T_map_asset);

  /// Null: there is none of this number.
  [[nodiscard]] const Thing* find(std::int64_t number) const;
  /// One that nobody saw, but that is in the map.
  void add(const std::string& asset, const std::string& class_name, const std::string& injection,
           const Transform& T_map_asset);
  /// It was put there, or lies there now. @pre it is there.
  void put(std::int64_t number, const std::string& injection, const Transform& T_map_asset);
  /// It is none, or is there no more.
  void drop(std::int64_t number);
  /// In the order of their numbers.
  [[nodiscard]] std::vector<Thing> list() const;

 private:
  struct Kept {
    Thing thing;
    double weight = 0;  ///< of the sightings that its place is the mean of
    Transform elsewhere = Transform::Identity();
    int agreeing = 0;  ///< sightings in a row that it is elsewhere
  };
  [[nodiscard]] Kept* thing_of(const Detection& detection, const std::string& asset, const Transform& T_map_asset);
  [[nodiscard]] bool make_room();

  std::map<std::int64_t, Kept> things_;
  std::map<std::pair<std::string, std::string>, std::int64_t> followed_;  ///< by who and their name for it
  std::int64_t last_number_ = 0;
};

}  // namespace concord
