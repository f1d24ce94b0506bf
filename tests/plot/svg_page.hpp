#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace planemap::plot {

/// Places on a page: pixels, x to the right, y down.
using Pixel = Eigen::Vector2d;

/// A rectangle on a page.
struct Box {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;

  double right() const { return x + width; }
  double bottom() const { return y + height; }
  Pixel middle() const { return {x + width / 2.0, y + height / 2.0}; }
};

/// One SVG drawing that reads well on light and on dark pages: its colours are classes, which each have a value for
/// both. Classes: text, soft, head, title; grid, axis; s0 to s5 for strokes of series, f0 to f5 for fills of them.
class SvgPage {
 public:
  /// @param title  said at the top and to readers that don't see
  /// @param subtitle  one line below it; may be empty
  SvgPage(double width, double height, std::string_view title, std::string_view subtitle);

  double width() const { return width_; }
  double height() const { return height_; }

  /// Adds SVG as it is.
  void raw(std::string_view svg) { body_ += svg; }
  /// Adds rules to the style sheet: one for light pages, and what replaces it on dark ones.
  void style(std::string_view light, std::string_view dark);
  void text(const Pixel& at, std::string_view text, std::string_view classes = "text", double turn_deg = 0.0);
  void line(const Pixel& from, const Pixel& to, std::string_view classes);
  /// A line with a head at its end.
  void arrow(const Pixel& from, const Pixel& to, std::string_view stroke_class, std::string_view fill_class);
  void polyline(std::span<const Pixel> points, std::string_view classes);
  void polygon(std::span<const Pixel> points, std::string_view classes);
  void circle(const Pixel& middle, double radius, std::string_view classes);
  /// An ellipse along the page's axes.
  void ellipse(const Pixel& middle, double radius_x, double radius_y, std::string_view classes);
  void rectangle(const Box& box, std::string_view classes);

  std::string svg() const;
  /// Throws std::runtime_error where the file can't be written.
  void save(const std::filesystem::path& file) const;

 private:
  double width_;
  double height_;
  std::string title_;
  std::string light_;
  std::string dark_;
  std::string body_;
};

}  // namespace planemap::plot
