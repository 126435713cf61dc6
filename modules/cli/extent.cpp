#include "cli/extent.hpp"

#include <cmath>

#include "cli/numbers.hpp"
#include "cli/report.hpp"

namespace concord {
namespace {

nlohmann::json numbers(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

struct ToJson {
  nlohmann::json operator()(const Box& box) const {
    return {{"shape", "box"}, {"min", numbers(box.min)}, {"max", numbers(box.max)}};
  }
  nlohmann::json operator()(const OrientedBox& box) const {
    return {{"shape", "oriented box"}, {"T_frame_box", to_numbers(box.T_frame_box)}, {"size", numbers(box.size)}};
  }
  nlohmann::json operator()(const Prism& prism) const {
    nlohmann::json points = nlohmann::json::array();
    for (const Eigen::Vector2d& p : prism.points) points.push_back({p.x(), p.y()});
    return {{"shape", "prism"}, {"points", points}, {"from", prism.low}, {"to", prism.high}};
  }
};

}  // namespace

Box extent(VoxelIndex min, VoxelIndex max, double resolution) {
  // 28 x 0.1 is 2.8000000000000003: to the micrometre it reads as it was meant.
  const auto metres = [&](int index) { return std::round(index * resolution * 1e6) / 1e6; };
  return {{metres(min.x), metres(min.y), metres(min.z)}, {metres(max.x + 1), metres(max.y + 1), metres(max.z + 1)}};
}

Box extent(const Volume& volume, const Transform& T_map_volume) {
  Eigen::AlignedBox3d around;
  for (const Eigen::Vector3d& corner : corners(volume)) around.extend(T_map_volume * corner);
  if (around.isEmpty()) return {};
  return {around.min(), around.max()};
}

std::string to_words(const Box& extent) {
  const auto metres = [](double value) { return format_number(std::round(value * 100) / 100 + 0.0, 2); };  // no -0.00
  std::string words;
  for (int i = 0; i < 3; ++i) {
    words += (i == 0 ? "" : "  ") + metres(extent.min[i]) + ".." + metres(extent.max[i]);
  }
  return words;
}

nlohmann::json to_json(const Box& extent) { return {{"min", numbers(extent.min)}, {"max", numbers(extent.max)}}; }

nlohmann::json to_json(const Volume& volume, const Transform& T_map_volume) {
  nlohmann::json json = std::visit(ToJson{}, volume);
  json["T_map_volume"] = to_numbers(T_map_volume);
  return json;
}

const char* kind_of(const Volume& volume) {
  if (std::holds_alternative<Box>(volume)) return "box";
  return std::holds_alternative<Prism>(volume) ? "prism" : "oriented box";
}

const char* name(Zone::Kind kind) {
  switch (kind) {
    case Zone::Kind::kNoGo: return "no-go";
    case Zone::Kind::kAllowContact: return "allow-contact";
    case Zone::Kind::kCostly: return "costly";
    case Zone::Kind::kCorridor: return "corridor";
  }
  return "";
}

}  // namespace concord
