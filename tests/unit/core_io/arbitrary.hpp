#pragma once

#include <rapidcheck.h>

#include <vector>

#include "core/brick_map.hpp"

namespace concord::test {

/// Known log-odds of either sign, the ends of the range included.
inline rc::Gen<LogOdds> arbitrary_value() {
  return rc::gen::oneOf(rc::gen::elementOf(std::vector<LogOdds>{kFree, kOccupied}),
                        rc::gen::elementOf(std::vector<LogOdds>{kPinnedFree, kPinnedOccupied, 0, -1}),
                        rc::gen::inRange<LogOdds>(kPinnedFree, kPinnedOccupied));
}

/// From empty to full and from one value to 512 of them: every form of the encoding occurs.
inline rc::Gen<Brick> arbitrary_brick() {
  return rc::gen::exec([] {
    const int percent = *rc::gen::element(0, 1, 10, 50, 99, 100);
    const auto values =
        *rc::gen::resize(*rc::gen::element(1, 2, 5, 60, 400),
                         rc::gen::nonEmpty(rc::gen::container<std::vector<LogOdds>>(arbitrary_value())));
    const auto seed = *rc::gen::arbitrary<std::uint32_t>();
    std::uint32_t random = seed | 1;
    const auto next = [&] { return random = random * 1664525u + 1013904223u, random >> 8; };
    DenseBrick dense;
    for (LogOdds& l : dense) {
      const bool known = next() % 100 < static_cast<std::uint32_t>(percent);
      l = known ? values[next() % values.size()] : kUnknown;
    }
    return Brick::from_dense(dense);
  });
}

inline rc::Gen<BrickIndex> arbitrary_index(int reach) {
  return rc::gen::map(
      rc::gen::tuple(rc::gen::inRange(-reach, reach), rc::gen::inRange(-reach, reach), rc::gen::inRange(-reach, reach)),
      [](const auto& t) {
        return BrickIndex{std::get<0>(t), std::get<1>(t), std::get<2>(t)};
      });
}

/// A handful of bricks, near each other or up to `reach` apart.
inline rc::Gen<BrickMap> arbitrary_map(int reach) {
  return rc::gen::exec([reach] {
    BrickMap map;
    const int spread = *rc::gen::element(2, reach);
    const int count = *rc::gen::inRange(0, 12);
    for (int i = 0; i < count; ++i) map.set(*arbitrary_index(spread), *arbitrary_brick());
    return map;
  });
}

}  // namespace concord::test
