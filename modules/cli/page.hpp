#pragma once

#include <cairo.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "cli/relief.hpp"

namespace concord {

struct SurfaceEnd {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
using Surface = std::unique_ptr<cairo_surface_t, SurfaceEnd>;

inline constexpr Rgb kPaper{0.945F, 0.935F, 0.91F};
inline constexpr Rgb kInk{0.13F, 0.14F, 0.17F};
inline constexpr Rgb kSoftInk{0.42F, 0.42F, 0.44F};

/// A sheet of paper in pixels, y down: shapes are traced first, then filled or stroked.
class Page {
 public:
  struct Type {
    double size;
    bool bold;
    Rgb colour;
  };

  Page(int width, int height);

  void move_to(const Eigen::Vector2d& p) { cairo_move_to(cairo(), p.x(), p.y()); }
  void line_to(const Eigen::Vector2d& p) { cairo_line_to(cairo(), p.x(), p.y()); }
  void rectangle(double x, double y, double width, double height) { cairo_rectangle(cairo(), x, y, width, height); }
  void rounded(double x, double y, double width, double height, double radius);
  void circle(const Eigen::Vector2d& centre, double radius);

  /// End the traced shape.
  void fill(const Rgb& colour, double opacity);
  void stroke(const Rgb& colour, double opacity, double width, const std::vector<double>& dashes = {});

  /// One line whose baseline is at y.
  void text(double x, double y, const std::string& line, const Type& type);
  void text_centred(double x, double y, const std::string& line, const Type& type);
  void text_right(double x, double y, const std::string& line, const Type& type);
  /// Lines of whole words no wider than `width`.
  [[nodiscard]] std::vector<std::string> wrapped(const std::string& words, double size, double width);

  [[nodiscard]] cairo_t* cairo() { return cairo_.get(); }
  [[nodiscard]] Result<void> write(const std::filesystem::path& png);

 private:
  struct CairoEnd {
    void operator()(cairo_t* context) const { cairo_destroy(context); }
  };

  void set_type(const Type& type);
  [[nodiscard]] double width_of(const std::string& line);

  Surface surface_;
  std::unique_ptr<cairo_t, CairoEnd> cairo_;
};

}  // namespace concord
