#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/detections.hpp"
#include "core/error.hpp"

namespace concord {

inline constexpr double kMoved = 0.15;  ///< metres
inline constexpr double kTurned = 0.5;  ///< radians
/// Whether an object that lies at the one lies at the other for all that sightings can tell.
[[nodiscard]] bool is_same_place(const Transform& a, const Transform& b);

/// What was seen, made into things: repeated sightings of one object are one.
///
/// A sighting is of the thing that who saw it followed under the same name; else of the nearest one of the same asset
/// within kSameThing; else of a new one. Until a person confirms it, a thing lies where its sightings lie on average,
/// each by its score, the last ten counting. Confirmed, it stays where it was put until kAgreeing sightings in a row
/// agree that it is somewhere else. Whoever is off a little sees it a little off, always: where it is seen while it
/// lies where it was put is as good as there. A move is kept for good, so each is called for twice as long after the
/// one before as that was, be it that nothing came of it or that the thing is always on its way; half as long for each
/// time that it was seen to lie still for kStill such pauses: so it is a tenth of its time where it is not, at most.
///
/// What a person dropped is known for none, and not told of, until nobody has seen it for kDroppedFor, or somebody puts
/// one there.
class Sightings {
 public:
  static constexpr double kSameThing = 0.5;  ///< metres
  static constexpr int kAgreeing = 3;
  static constexpr std::size_t kMostFollowers = 32;       ///< of one thing, who have a name for it
  static constexpr std::int64_t kFirstPause = 5'000'000;  ///< after a move was called for, microseconds
  static constexpr std::int64_t kLongestPause = 600'000'000;
  static constexpr int kStill = 10;
  static constexpr std::int64_t kDroppedFor = 600'000'000;  ///< microseconds
  /// None twice, over all restarts. Refused: kIo.
  using NextNumber = std::function<Result<std::int64_t>()>;

  explicit Sightings(NextNumber next_number) : next_number_(std::move(next_number)) {}

  struct Seen {
    std::int64_t number = 0;
    bool is_new = false;
    bool is_dropped = false;            ///< a person said that it is none
    std::optional<Transform> moved_to;  ///< it was confirmed, and lies there now: it has to be moved
  };
  /// @param asset the one that was seen, whatever name the detection has for it. @param now microseconds, ours: who
  /// sees has a clock of their own. Refused (kTooLarge): one thing more than kMaxThings, all of which are confirmed;
  /// else the one that was not seen for the longest time gives way, dropped ones first.
  [[nodiscard]] Result<Seen> see(const Detection& detection, const std::string& asset, const std::string& class_name,
                                 const Transform& T_map_asset, std::int64_t now);

  /// Null: there is none of this number, or it was dropped.
  [[nodiscard]] const Thing* find(std::int64_t number) const;
  /// One that nobody saw, but that is in the map.
  void add(const std::string& asset, const std::string& class_name, const std::string& injection,
           const Transform& T_map_asset);
  /// It was put there, or lies there now. @pre it is there.
  void put(std::int64_t number, const std::string& injection, const Transform& T_map_asset);
  /// Where it was seen last, as elsewhere, it is seen while it lies where it was put. @pre it is there.
  void seen_there(std::int64_t number);
  /// It is there no more.
  void forget(std::int64_t number);
  /// A person says that it is none. What others call it is let go: the object that they follow may be elsewhere.
  void drop(std::int64_t number);
  /// Lets go of what was dropped and not seen for long.
  void forget_dropped(std::int64_t now);
  /// In the order of their numbers; not those that were dropped.
  [[nodiscard]] std::vector<Thing> list() const;

 private:
  struct Kept {
    Thing thing;
    bool is_dropped = false;
    std::int64_t heard = 0;  ///< when it was seen last, by our clock
    double weight = 0;       ///< of the sightings that its place is the mean of
    Transform elsewhere = Transform::Identity();
    int agreeing = 0;                  ///< sightings in a row that it is elsewhere
    std::optional<Transform> seen_at;  ///< while it lies where it was put
    std::int64_t next_move = 0, pause = kFirstPause;
    std::optional<std::int64_t> still_since;
    std::map<std::string, std::string> names;  ///< by who follows it
  };
  [[nodiscard]] static bool lies_at(const Kept& kept, const Transform& T_map_asset);
  [[nodiscard]] Result<Kept*> add_thing(const std::string& asset, const Transform& T_map_asset);
  void follow(const Detection& detection, Kept& kept);
  static void see_there(Kept& kept, std::int64_t now);
  static void see_elsewhere(Kept& kept, const Transform& T_map_asset, std::int64_t now, Seen& seen);
  [[nodiscard]] Kept* thing_of(const Detection& detection, const std::string& asset, const Transform& T_map_asset);
  [[nodiscard]] bool make_room();
  template <class Which>
  void forget_those(Which which);
  void forget_dropped_at(const std::string& asset, const Transform& T_map_asset);

  std::map<std::int64_t, Kept> things_;
  std::map<std::pair<std::string, std::string>, std::int64_t> followed_;  ///< by who and their name for it
  NextNumber next_number_;
};

}  // namespace concord
