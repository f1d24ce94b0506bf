#include "plot/chart.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace planemap::plot {

namespace {

double round_step(double span, int wanted) {
  const double raw = span / std::max(wanted, 1);
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= raw * (1.0 - 1e-9)) return factor * decade;
  }
  return 10.0 * decade;
}

}  // namespace

std::vector<double> round_ticks(double from, double to, int wanted) {
  std::vector<double> ticks;
  if (!(to > from)) return ticks;
  const double step = round_step(to - from, wanted);
  const auto first = static_cast<long>(std::ceil(from / step - 1e-9));
  const auto last = static_cast<long>(std::floor(to / step + 1e-9));
  for (long i = first; i <= last; ++i) ticks.push_back(static_cast<double>(i) * step);
  return ticks;
}

Axis axis_from_zero(const std::string& label, double greatest) {
  const double least_top = std::max(greatest, 1e-12);
  const double step = round_step(least_top, 5);
  return {label, 0.0, step * std::ceil(least_top / step - 1e-9)};
}

Chart::Chart(SvgPage& page, const Box& box, const std::string& head, const Axis& x, const Axis& y)
    : page_(page), box_(box), x_(x), y_(y) {
  draw_axes(head);
}

void Chart::draw_axes(const std::string& head) {
  page_.text({box_.x, box_.y - 14.0}, head, "text head");
  for (const double tick : round_ticks(x_.from, x_.to, static_cast<int>(box_.width / 75.0))) {
    const double x = at({tick, y_.from}).x();
    page_.line({x, box_.y}, {x, box_.bottom()}, "grid");
    page_.text({x, box_.bottom() + 17.0}, fmt::format("{:g}", tick), "soft mid");
  }
  for (const double tick : round_ticks(y_.from, y_.to, static_cast<int>(box_.height / 45.0))) {
    const double y = at({x_.from, tick}).y();
    page_.line({box_.x, y}, {box_.right(), y}, "grid");
    page_.text({box_.x - 8.0, y + 4.0}, fmt::format("{:g}", tick), "soft end");
  }
  page_.line({box_.x, box_.bottom()}, {box_.right(), box_.bottom()}, "axis");
  page_.text({box_.middle().x(), box_.bottom() + 37.0}, x_.label, "text mid");
  page_.text({box_.x - 44.0, box_.middle().y()}, y_.label, "text mid", -90.0);
}

Pixel Chart::at(const Datum& datum) const {
  return {box_.x + box_.width * (datum.x() - x_.from) / (x_.to - x_.from),
          box_.bottom() - box_.height * (datum.y() - y_.from) / (y_.to - y_.from)};
}

void Chart::line(std::span<const Datum> data, const std::string& classes) {
  std::vector<Pixel> points;
  for (const Datum& datum : data) points.push_back(at(datum));
  page_.polyline(points, classes);
}

void Chart::marks(std::span<const Datum> data, const std::string& classes) {
  for (const Datum& datum : data) page_.circle(at(datum), 3.5, classes);
}

void Chart::band(std::span<const Datum> lower, std::span<const Datum> upper, const std::string& classes) {
  std::vector<Pixel> outline;
  for (const Datum& datum : upper) outline.push_back(at(datum));
  for (auto datum = lower.rbegin(); datum != lower.rend(); ++datum) outline.push_back(at(*datum));
  page_.polygon(outline, classes);
}

void Chart::level(double y, const std::string& label, const std::string& classes) {
  page_.line(at({x_.from, y}), at({x_.to, y}), classes);
  page_.text(at({x_.to, y}) + Pixel(-4.0, -5.0), label, "soft small end halo");
}

void Chart::legend(const std::string& fill_class, const std::string& text, bool on_the_right) {
  const double y = box_.y + 14.0 + 18.0 * legend_rows_++;
  const double x = on_the_right ? box_.right() - 24.0 : box_.x + 12.0;
  page_.rectangle({x, y - 9.0, 12.0, 10.0}, fill_class);
  page_.text({on_the_right ? x - 7.0 : x + 19.0, y}, text, on_the_right ? "text halo end" : "text halo");
}

}  // namespace planemap::plot
