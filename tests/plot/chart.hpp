#pragma once

#include <span>
#include <string>
#include <vector>

#include "plot/svg_page.hpp"

namespace planemap::plot {

/// What one axis of a chart shows.
struct Axis {
  std::string label;  ///< with its unit
  double from = 0.0;
  double to = 1.0;
};

/// Round numbers from `from` to `to`, both included where they are round themselves; about `wanted` of them.
std::vector<double> round_ticks(double from, double to, int wanted = 5);
/// An axis from 0 to a round number that is at least `greatest`.
Axis axis_from_zero(const std::string& label, double greatest);

/// A place in a chart, in the axes' units.
using Datum = Eigen::Vector2d;

/// One chart on a page: axes, ticks and a grid at once, then series. Names of series are classes of the page, s0 or f0.
class Chart {
 public:
  /// @param box  of the plot itself; ticks and labels are outside
  Chart(SvgPage& page, const Box& box, const std::string& head, const Axis& x, const Axis& y);

  Pixel at(const Datum& datum) const;
  void line(std::span<const Datum> data, const std::string& classes);
  void marks(std::span<const Datum> data, const std::string& classes);
  /// The area between two curves over the same x.
  void band(std::span<const Datum> lower, std::span<const Datum> upper, const std::string& classes);
  /// A level that the data are compared with.
  void level(double y, const std::string& label, const std::string& classes);
  /// A row of the legend in the upper left corner (or the upper right one).
  void legend(const std::string& fill_class, const std::string& text, bool on_the_right = false);

 private:
  void draw_axes(const std::string& head);

  SvgPage& page_;
  Box box_;
  Axis x_;
  Axis y_;
  int legend_rows_ = 0;
};

}  // namespace planemap::plot
