#pragma once

#include <map>
#include <string>
#include <vector>

#include "align_cases.hpp"

namespace concord::bench {

/// Answers to one kind of request.
struct Tally {
  int asked = 0;
  int found = 0;  ///< within the gate and one degree, whatever the verdict
  int accepted = 0;
  int accepted_right = 0;
  int fooled = 0;          ///< accepted beyond 0.3 m or 2 degrees
  std::vector<double> ms;  ///< processor time of the answer alone
  std::map<std::string, int> reasons;

  void add(const Pair& pair, const Alignment& answer, double spent_ms);
};
using Table = std::map<std::string, Tally>;

struct Amount {
  int guesses = 20;    ///< a pair
  int placements = 2;  ///< a pair, without a guess: the source turned and shifted anew
  int threads = 1;
};

/// The real pairs: with a guess; without one; without one and gravity off by 3 degrees.
[[nodiscard]] Table success_on_pairs(const std::vector<Pair>& pairs, const Amount& amount);
/// Rooms cut in two: overlap of 40 to 70 %, and of 30 to 40 %.
[[nodiscard]] Table success_on_rooms(const std::vector<Scene>& rooms, const Amount& amount);
/// Rooms cut in two and disturbed: noise, outliers, no ceiling, a moved shelf.
[[nodiscard]] Table success_disturbed(const std::vector<Scene>& rooms, const Amount& amount);
/// Nothing here has an answer: parts without overlap, wrong rooms, mirrored rooms, corridors; about `requests` of them.
[[nodiscard]] Table never_fooled(const std::vector<Scene>& rooms, const std::vector<Pair>& pairs, int requests,
                                 int threads);

}  // namespace concord::bench
