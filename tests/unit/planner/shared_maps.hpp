#pragma once

#include <cctype>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace concord {

/// Other people's maps in ../shared/data, each with its queries beside it; the README there names the sources.
inline auto shared_maps() {
  return testing::Values("movingai/16room_000.map", "movingai/AR0300SR.map", "movingai/Berlin_0_512.map",
                         "movingai/Boston_0_512.map", "movingai/arena2.map", "movingai/brc202d.map",
                         "movingai/den520d.map", "movingai/maze512-32-0.map", "movingai/random512-10-0.map",
                         "movingai/random512-25-0.map", "buildings_conf/depot_r030.map",
                         "buildings_conf/warehouse_r030.map", "buildings_conf/warehouse_keepout_r030.map");
}

/// As a test may be called.
template <class Param>
std::string map_name(const Param& map) {
  std::string name = std::filesystem::path(map.param).stem().string();
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

}  // namespace concord
