#include "cli/overview.hpp"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "cli/numbers.hpp"
#include "cli/page.hpp"
#include "cli/relief.hpp"

namespace concord {
namespace {

constexpr Rgb kBurgundy{0.50F, 0.06F, 0.20F};
constexpr Rgb kAmber{0.96F, 0.72F, 0.0F};
constexpr Rgb kRed{0.89F, 0.18F, 0.19F};
constexpr Rgb kGreen{0.07F, 0.58F, 0.32F};
constexpr Rgb kCyan{0.0F, 0.66F, 0.76F};

constexpr double kPanel = 470, kPad = 44;
constexpr double kMapWidth = 1420, kMinMapHeight = 900, kMaxMapHeight = 1500;

/// Places the relief on the page as large as it goes.
struct MapArea {
  MapArea(const Relief& relief, double resolution_)
      : resolution(resolution_),
        scale(std::min(kMapWidth / relief.width, kMaxMapHeight / relief.height)),
        width(relief.width * scale),
        height(relief.height * scale) {
    frame.height = static_cast<int>(std::max(height, kMinMapHeight) + 2 * kPad);
    frame.width = static_cast<int>(kPad + kMapWidth + kPad + kPanel + kPad);
    left = kPad + (kMapWidth - width) / 2;
    top = (frame.height - height) / 2;
    frame.pixels_per_metre = scale / resolution;
    frame.origin = {left - relief.min_x * scale, top + (relief.min_y + relief.height) * scale};
  }

  [[nodiscard]] Eigen::Vector2d voxel_corner(double x, double y) const {
    return frame.pixel_of({x * resolution, y * resolution});
  }

  double resolution;
  double scale;  ///< pixels a voxel
  double width, height;
  double left = 0, top = 0;
  OverviewFrame frame;
};

void draw_relief(Page& page, const MapArea& area, const Relief& relief, double cut) {
  const std::vector<std::uint32_t> pixels = shade(relief, area.resolution, cut);
  const Surface picture(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, relief.width, relief.height));
  cairo_surface_flush(picture.get());
  unsigned char* data = cairo_image_surface_get_data(picture.get());
  const int stride = cairo_image_surface_get_stride(picture.get());
  for (int row = 0; row < relief.height; ++row) {
    const std::uint32_t* from = &pixels[static_cast<std::size_t>(relief.height - 1 - row) * relief.width];
    std::memcpy(data + static_cast<std::ptrdiff_t>(row) * stride, from, sizeof(*from) * relief.width);
  }
  cairo_surface_mark_dirty(picture.get());

  cairo_t* cr = page.cairo();
  cairo_save(cr);
  cairo_translate(cr, area.left, area.top);
  cairo_scale(cr, area.scale, area.scale);
  cairo_set_source_surface(cr, picture.get(), 0, 0);
  cairo_pattern_set_filter(cairo_get_source(cr), area.scale >= 2 ? CAIRO_FILTER_NEAREST : CAIRO_FILTER_BEST);
  cairo_paint(cr);
  cairo_restore(cr);
}

/// The more of a column is contradicted the stronger: a wall that one submap lacks stands out, a floor that lies half a
/// voxel deeper in one of them does not.
void draw_conflicts(Page& page, const MapArea& area, const Relief& relief) {
  constexpr int kFull = 10;
  const double side = std::max(area.scale, 2.0);
  for (int strength = 1; strength <= kFull; ++strength) {
    for (int row = 0; row < relief.height; ++row) {
      for (int column = 0; column < relief.width; ++column) {
        const int conflicts = relief.cells[static_cast<std::size_t>(row) * relief.width + column].conflicts;
        if (std::min(conflicts, kFull) != strength) continue;
        const Eigen::Vector2d corner = area.voxel_corner(relief.min_x + column, relief.min_y + row + 1);
        page.rectangle(corner.x(), corner.y(), side, side);
      }
    }
    page.fill(kAmber, 0.8 * strength / kFull);
  }
}

void draw_edit(Page& page, const MapArea& area, const std::vector<VoxelIndex>& edit) {
  if (edit.empty()) return;
  std::set<std::pair<std::int32_t, std::int32_t>> columns;
  for (const VoxelIndex& v : edit) columns.emplace(v.x, v.y);
  const auto trace = [&](double grown) {
    for (const auto& [x, y] : columns) {
      const Eigen::Vector2d corner = area.voxel_corner(x, y + 1);
      page.rectangle(corner.x() - grown, corner.y() - grown, area.scale + 2 * grown, area.scale + 2 * grown);
    }
  };
  trace(7);
  page.fill(kCyan, 0.28);
  trace(1.5);
  page.fill(kBurgundy, 1.0);
}

void draw_route(Page& page, const MapArea& area, const Overview::Route& route, const Rgb& colour, bool dashed) {
  if (route.points.size() < 2) return;
  const auto trace = [&] {
    for (std::size_t i = 0; i < route.points.size(); ++i) {
      const Eigen::Vector2d p = area.frame.pixel_of(route.points[i]);
      i == 0 ? page.move_to(p) : page.line_to(p);
    }
  };
  trace();
  page.stroke({1, 1, 1}, 0.85, dashed ? 8.5 : 11);
  trace();
  page.stroke(colour, 1.0, dashed ? 4.5 : 6.5, dashed ? std::vector<double>{13, 10} : std::vector<double>{});
}

void draw_marker(Page& page, const MapArea& area, const Eigen::Vector2d& p_map, const char* letter) {
  const Eigen::Vector2d p = area.frame.pixel_of(p_map);
  page.circle(p, 15);
  page.fill({1, 1, 1}, 1.0);
  page.circle(p, 12.5);
  page.fill(kInk, 1.0);
  page.text_centred(p.x(), p.y() + 5.5, letter, {16, true, {1, 1, 1}});
}

void draw_scale_bar(Page& page, const MapArea& area) {
  double metres = 1;
  for (const double candidate : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0}) {
    if (candidate * area.frame.pixels_per_metre < kMapWidth * 0.25) metres = candidate;
  }
  const double length = metres * area.frame.pixels_per_metre;
  const double x = kPad, y = area.frame.height - 24;
  page.rectangle(x, y - 5, length / 2, 5);
  page.fill(kInk, 1.0);
  page.rectangle(x + length / 2, y - 5, length / 2, 5);
  page.fill({1, 1, 1}, 1.0);
  page.rectangle(x, y - 5, length, 5);
  page.stroke(kInk, 1.0, 1.2);
  page.text(x + length + 10, y + 2, format_number(metres, 0) + " m", {14, false, kInk});
}

std::string told(const Overview::Route& route) {
  return route.status == "OK" ? format_number(route.length, 1) + " m" : route.status;
}

/// Everything that is written: a column to the right of the map.
class Panel {
 public:
  Panel(Page& page, double left, double top) : page_(page), left_(left), y_(top) {}

  void heading(const Overview& overview) {
    y_ += 34;
    page_.text(left_, y_, overview.title, {34, true, kInk});
    y_ += 10;
    for (const std::string& line : page_.wrapped(overview.subtitle, 15, kPanel)) {
      y_ += 21;
      page_.text(left_, y_, line, {15, false, kSoftInk});
    }
  }

  void section(const std::string& name) {
    y_ += 44;
    page_.text(left_, y_, name, {13, true, kSoftInk});
    page_.rectangle(left_, y_ + 8, kPanel, 1);
    page_.fill(kSoftInk, 0.35);
    y_ += 12;
  }

  void swatch(const Rgb& colour, const std::string& name, const std::string& value) {
    y_ += 26;
    page_.rounded(left_, y_ - 13, 26, 15, 4);
    page_.fill(colour, 1.0);
    line(38, name, value);
  }

  void ribbon(const Rgb& colour, bool dashed, const std::string& name, const std::string& value) {
    y_ += 26;
    page_.move_to({left_, y_ - 5});
    page_.line_to({left_ + 26, y_ - 5});
    page_.stroke(colour, 1.0, 5, dashed ? std::vector<double>{8, 8} : std::vector<double>{});
    line(38, name, value);
  }

  void remark(const std::string& words) {
    y_ += 4;
    for (const std::string& line : page_.wrapped(words, 13, kPanel - 38)) {
      y_ += 18;
      page_.text(left_ + 38, y_, line, {13, false, kSoftInk});
    }
  }

  void number(const std::string& name, const std::string& value) {
    y_ += 25;
    line(0, name, value);
  }

  void feature_head() {
    y_ += 22;
    const char* names[] = {"robot", "merged", "edited"};
    for (int i = 0; i < 3; ++i) page_.text_centred(bar(i) + kBar / 2, y_, names[i], {13, false, kSoftInk});
  }

  void feature(const Overview::Feature& feature) {
    y_ += 26;
    page_.text(left_, y_, feature.name, {15, false, kInk});
    const std::optional<double> shares[] = {feature.robot, feature.merged, feature.edited};
    for (int i = 0; i < 3; ++i) {
      page_.rounded(bar(i), y_ - 12, kBar, 14, 3);
      page_.fill(kSoftInk, 0.16);
      if (!shares[i]) continue;
      const double share = std::clamp(*shares[i], 0.0, 1.0);
      if (share > 0.01) {
        page_.rounded(bar(i), y_ - 12, std::max(kBar * share, 6.0), 14, 3);
        page_.fill(share >= 0.5 ? kGreen : kRed, 0.85);
      }
      page_.text_centred(bar(i) + kBar / 2, y_ - 1, format_number(100 * share, 0) + " %",
                         {11, true, share > 0.75 ? Rgb{1, 1, 1} : kInk});
    }
  }

  [[nodiscard]] double bottom() const { return y_; }

 private:
  static constexpr double kBar = 72;

  [[nodiscard]] double bar(int i) const { return left_ + kPanel - (3 - i) * (kBar + 8) + 8; }

  void line(double indent, const std::string& name, const std::string& value) {
    page_.text(left_ + indent, y_, name, {15, false, kInk});
    page_.text_right(left_ + kPanel, y_, value, {15, true, kInk});
  }

  Page& page_;
  double left_, y_;
};

double draw_panel(Page& page, const Overview& overview, const MapArea& area, bool conflicts) {
  Panel panel(page, kPad + kMapWidth + kPad, kPad);
  panel.heading(overview);
  if (!overview.agents.empty()) {
    panel.section("SUBMAPS");
    for (std::size_t i = 0; i < overview.agents.size(); ++i) {
      panel.swatch(agent_colour(i), overview.agents[i].id, format_count(overview.agents[i].voxels) + " voxels");
    }
  }
  if (conflicts || !overview.edit.empty()) {
    panel.section("PEOPLE AND CONFLICTS");
    if (!overview.edit.empty()) {
      panel.swatch(kBurgundy, "edit", format_count(static_cast<std::int64_t>(overview.edit.size())) + " voxels");
    }
    if (conflicts) {
      panel.swatch(kAmber, "conflict",
                   format_count(static_cast<std::int64_t>(overview.conflicts->known_count())) + " voxels");
    }
  }
  if (overview.before || overview.after) {
    panel.section("PATH A TO B");
    const auto tell = [&](const Overview::Route& route, const Rgb& colour, bool dashed, const char* name) {
      panel.ribbon(colour, dashed, name, told(route));
      if (route.status != "OK") panel.remark(route.message);
    };
    if (overview.before) tell(*overview.before, kRed, true, overview.edit.empty() ? "path" : "before the edit");
    if (overview.after) tell(*overview.after, kGreen, false, overview.before ? "after the edit" : "path");
    if (!overview.driven.empty()) panel.remark("dots: where the robot was on its way");
  }
  if (!overview.features.empty()) {
    panel.section("FOUND");
    panel.feature_head();
    for (const auto& feature : overview.features) panel.feature(feature);
  }
  if (!overview.numbers.empty()) {
    panel.section("NUMBERS");
    for (const auto& [name, value] : overview.numbers) panel.number(name, value);
  }
  page.text(kPad + kMapWidth + kPad, area.frame.height - 22,
            "seen from above, cut at z = " + format_number(overview.cut, 1) + " m" +
                (overview.agents.size() > 1 ? "; striped where submaps agree" : ""),
            {12, false, kSoftInk});
  return panel.bottom();
}

}  // namespace

Result<OverviewFrame> write_overview(const Overview& overview, const std::filesystem::path& png) {
  Relief relief = look_down(overview);
  if (relief.cells.empty()) {
    return refuse(Code::kEmpty, "the map holds nothing below z = " + format_number(overview.cut, 1) + " m to draw");
  }
  MapArea area(relief, overview.resolution);
  Page page(area.frame.width, area.frame.height);
  draw_relief(page, area, relief, overview.cut);
  if (overview.conflicts != nullptr) draw_conflicts(page, area, relief);
  draw_edit(page, area, overview.edit);
  if (overview.before) draw_route(page, area, *overview.before, kRed, true);
  if (overview.after) draw_route(page, area, *overview.after, kGreen, false);
  for (const Eigen::Vector2d& p : overview.driven) {
    page.circle(area.frame.pixel_of(p), 5);
    page.fill(kInk, 0.9);
  }
  if (overview.start) draw_marker(page, area, *overview.start, "A");
  if (overview.goal) draw_marker(page, area, *overview.goal, "B");
  draw_scale_bar(page, area);
  draw_panel(page, overview, area, overview.conflicts != nullptr && !overview.conflicts->empty());
  if (auto written = page.write(png); !written) return tl::unexpected(written.error());
  return area.frame;
}

}  // namespace concord
