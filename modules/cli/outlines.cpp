#include "cli/outlines.hpp"

#include "cli/page.hpp"

namespace concord {

Result<void> draw_outlines(const Outlines& outlines, const OverviewFrame& frame, const std::filesystem::path& png) {
  const Surface surface(cairo_image_surface_create_from_png(png.c_str()));
  cairo_t* page = cairo_create(surface.get());
  cairo_set_line_width(page, 1);
  cairo_set_source_rgba(page, kInk.r, kInk.g, kInk.b, 0.6);
  for (const auto& outline : outlines) {
    for (const Eigen::Vector2d& corner : outline) {
      const Eigen::Vector2d p = frame.pixel_of(corner);
      cairo_line_to(page, p.x(), p.y());
    }
    cairo_close_path(page);
    cairo_stroke(page);
  }
  const bool drawn = cairo_status(page) == CAIRO_STATUS_SUCCESS;
  cairo_destroy(page);
  if (drawn && cairo_surface_write_to_png(surface.get(), png.c_str()) == CAIRO_STATUS_SUCCESS) return {};
  return refuse(Code::kIo, "cannot draw into " + png.string());
}

}  // namespace concord
