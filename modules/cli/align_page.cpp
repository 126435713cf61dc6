#include "cli/align_page.hpp"

#include <algorithm>
#include <vector>

#include "cli/numbers.hpp"
#include "cli/page.hpp"

namespace concord {
namespace {

constexpr Rgb kTarget{0.16F, 0.27F, 0.45F};
constexpr Rgb kSource{0.91F, 0.36F, 0.05F};
constexpr double kSide = 900, kPad = 36, kHead = 96;
constexpr float kUprightNormalZ = 0.6F;
constexpr double kMargin = 1.0;  // metres

/// Seen from above: the walls and what stands about.
std::vector<Eigen::Vector3d> walls_of(const AlignMap& map) {
  std::vector<Eigen::Vector3d> walls;
  for (const SurfaceCell& cell : map.fine().cells()) {
    const bool is_wall = cell.is_flat() && std::abs(cell.normal.z()) < kUprightNormalZ;
    if (is_wall || cell.is_solid) walls.push_back(cell.mean.cast<double>());
  }
  return walls;
}

void keep(std::vector<double>& values, double& low, double& high) {
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() / 200;  // far returns would leave the rest small
  low = std::min(low, values[cut] - kMargin);
  high = std::max(high, values[values.size() - 1 - cut] + kMargin);
}

struct Window {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-1e9);

  void add(const std::vector<Eigen::Vector3d>& points, const Transform& T) {
    std::vector<double> x, y;
    for (const Eigen::Vector3d& p : points) {
      const Eigen::Vector3d q = T * p;
      x.push_back(q.x());
      y.push_back(q.y());
    }
    keep(x, low.x(), high.x());
    keep(y, low.y(), high.y());
  }
  [[nodiscard]] double scale() const { return kSide / (high - low).maxCoeff(); }
};

struct Panel {
  const Window& window;
  double left;

  void dots(Page& page, const std::vector<Eigen::Vector3d>& points, const Transform& T, double cell,
            const Rgb& colour) const {
    const double side = std::max(1.2, cell * window.scale());
    for (const Eigen::Vector3d& p : points) {
      const Eigen::Vector2d q = (T * p).head<2>();
      if ((q - window.low).minCoeff() < 0.0 || (window.high - q).minCoeff() < 0.0) continue;
      const Eigen::Vector2d at = (q - window.low) * window.scale();
      page.rectangle(left + at.x() - 0.5 * side, kHead + kSide - at.y() - 0.5 * side, side, side);
    }
    page.fill(colour, 0.55);
  }
};

}  // namespace

Result<void> write_align_page(const AlignPage& content, const std::filesystem::path& png) {
  const auto target = walls_of(*content.target_map);
  const auto source = walls_of(*content.source_map);
  if (target.empty() || source.empty()) return refuse(Code::kEmpty, "one of the maps has no walls to draw");
  Window window;
  window.add(target, Transform::Identity());
  window.add(source, content.T_target_source_after);
  Page page(static_cast<int>(3 * kPad + 2 * kSide), static_cast<int>(kHead + kSide + 2 * kPad));
  const std::pair<const char*, Transform> views[] = {{"before", content.T_target_source_before},
                                                     {"after", content.T_target_source_after}};
  double left = kPad;
  for (const auto& [title, T] : views) {
    page.rectangle(left, kHead, kSide, kSide);
    page.fill({1, 1, 1}, 1.0);
    const Panel panel{window, left};
    panel.dots(page, target, Transform::Identity(), content.target_map->fine().size(), kTarget);
    panel.dots(page, source, T, content.source_map->fine().size(), kSource);
    page.text(left, kHead - 14, title, {22, true, kInk});
    left += kSide + kPad;
  }
  page.text(kPad, 36, content.target, {18, true, kTarget});
  page.text(kPad, 60, content.source, {18, true, kSource});
  page.text_right(2 * kPad + 2 * kSide, 36, content.verdict, {15, false, kInk});
  const double metre = window.scale();
  page.rectangle(kPad, kHead + kSide + 14, 2.0 * metre, 6);
  page.fill(kInk, 1.0);
  page.text(kPad + 2.0 * metre + 10, kHead + kSide + 22, "2 m", {14, false, kInk});
  return page.write(png);
}

}  // namespace concord
