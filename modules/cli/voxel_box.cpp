#include "cli/voxel_box.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

#include "cli/numbers.hpp"

namespace concord {
namespace {

struct MetricBox {
  std::array<double, 3> min, max;
};

std::optional<MetricBox> box_of(const BrickMasks& voxels, double r) {
  const auto box = bounds_of(voxels);
  if (!box) return std::nullopt;
  const auto& [low, high] = *box;
  // 21 * 0.05 is 1.0500000000000003; nobody wants more than a nanometre.
  const auto metres = [r](int edge) { return std::round(edge * r * 1e9) / 1e9; };
  return MetricBox{{metres(low.x), metres(low.y), metres(low.z)},
                   {metres(high.x + 1), metres(high.y + 1), metres(high.z + 1)}};
}

}  // namespace

nlohmann::json box_json(const BrickMasks& voxels, double resolution) {
  const auto box = box_of(voxels, resolution);
  if (!box) return nullptr;
  return {{"min", box->min}, {"max", box->max}};
}

std::string box_words(const BrickMasks& voxels, double resolution) {
  const auto box = box_of(voxels, resolution);
  if (!box) return "none";
  std::string words;
  for (std::size_t i = 0; i < 3; ++i) {
    words += (i == 0 ? "" : ", ") + format_number(box->min[i], 2) + " to " + format_number(box->max[i], 2);
  }
  return words + " m";
}

}  // namespace concord
