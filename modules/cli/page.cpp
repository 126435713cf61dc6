#include "cli/page.hpp"

#include <numbers>
#include <sstream>

namespace concord {

Page::Page(int width, int height)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)), cairo_(cairo_create(surface_.get())) {
  rectangle(0, 0, width, height);
  fill(kPaper, 1.0);
  cairo_set_line_join(cairo(), CAIRO_LINE_JOIN_ROUND);
}

void Page::rounded(double x, double y, double width, double height, double radius) {
  constexpr double kRight = std::numbers::pi / 2;
  radius = std::min({radius, width / 2, height / 2});
  cairo_new_sub_path(cairo());
  cairo_arc(cairo(), x + width - radius, y + radius, radius, -kRight, 0);
  cairo_arc(cairo(), x + width - radius, y + height - radius, radius, 0, kRight);
  cairo_arc(cairo(), x + radius, y + height - radius, radius, kRight, 2 * kRight);
  cairo_arc(cairo(), x + radius, y + radius, radius, 2 * kRight, 3 * kRight);
  cairo_close_path(cairo());
}

void Page::circle(const Eigen::Vector2d& centre, double radius) {
  cairo_new_sub_path(cairo());
  cairo_arc(cairo(), centre.x(), centre.y(), radius, 0, 2 * std::numbers::pi);
}

void Page::fill(const Rgb& colour, double opacity) {
  cairo_set_source_rgba(cairo(), colour.r, colour.g, colour.b, opacity);
  cairo_fill(cairo());
}

void Page::stroke(const Rgb& colour, double opacity, double width, const std::vector<double>& dashes) {
  cairo_set_source_rgba(cairo(), colour.r, colour.g, colour.b, opacity);
  cairo_set_line_width(cairo(), width);
  cairo_set_line_cap(cairo(), dashes.empty() ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
  cairo_set_dash(cairo(), dashes.data(), static_cast<int>(dashes.size()), 0);
  cairo_stroke(cairo());
}

void Page::set_type(const Type& type) {
  cairo_select_font_face(cairo(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         type.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo(), type.size);
  cairo_set_source_rgb(cairo(), type.colour.r, type.colour.g, type.colour.b);
}

double Page::width_of(const std::string& line) {
  cairo_text_extents_t extents;
  cairo_text_extents(cairo(), line.c_str(), &extents);
  return extents.x_advance;
}

void Page::text(double x, double y, const std::string& line, const Type& type) {
  set_type(type);
  cairo_move_to(cairo(), x, y);
  cairo_show_text(cairo(), line.c_str());
  cairo_new_path(cairo());
}

void Page::text_centred(double x, double y, const std::string& line, const Type& type) {
  set_type(type);
  text(x - width_of(line) / 2, y, line, type);
}

void Page::text_right(double x, double y, const std::string& line, const Type& type) {
  set_type(type);
  text(x - width_of(line), y, line, type);
}

std::vector<std::string> Page::wrapped(const std::string& words, double size, double width) {
  set_type({size, false, kInk});
  std::vector<std::string> lines;
  std::istringstream in(words);
  for (std::string word; in >> word;) {
    if (!lines.empty() && width_of(lines.back() + " " + word) <= width) {
      lines.back() += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

Result<void> Page::write(const std::filesystem::path& png) {
  cairo_surface_flush(surface_.get());
  const cairo_status_t status = cairo_surface_write_to_png(surface_.get(), png.c_str());
  if (status == CAIRO_STATUS_SUCCESS) return {};
  return refuse(Code::kIo, "cannot write " + png.string() + ": " + cairo_status_to_string(status) +
                               "; check that the folder exists and may be written");
}

}  // namespace concord
