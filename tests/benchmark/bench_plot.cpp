#include "bench_plot.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <plot/chart.hpp>
#include <vector>

namespace planemap::benchmark {

namespace {

constexpr double kLeftPx = 190.0;
constexpr double kRightPx = 900.0;
constexpr double kRowPx = 34.0;
constexpr double kTopPx = 90.0;

bool is_stage(const std::string& part) {
  return part.find('.') != std::string::npos;
}

}  // namespace

void draw_bench(const BenchReport& report, const std::string& subtitle, const std::filesystem::path& file) {
  const std::vector<std::string> parts = report.parts();
  double greatest_ms = 0.0;
  double rows = 0.0;
  for (const std::string& part : parts) {
    greatest_ms = std::max(greatest_ms, report.own_median_ms(part));
    if (!is_stage(part)) rows += 1.0;
  }
  const plot::Axis axis = plot::axis_from_zero("ms, the thread's own time, median", greatest_ms);
  const auto x_of = [&](double ms) { return kLeftPx + (kRightPx - kLeftPx) * ms / axis.to; };
  const double bottom_px = kTopPx + rows * kRowPx;
  plot::SvgPage page(960.0, bottom_px + 60.0, "A scan, beside its peers", subtitle);
  for (const double tick : plot::round_ticks(axis.from, axis.to, 8)) {
    page.line({x_of(tick), kTopPx - 8.0}, {x_of(tick), bottom_px}, "grid");
    page.text({x_of(tick), bottom_px + 18.0}, fmt::format("{:g}", tick), "soft mid");
  }
  page.text({x_of(0.5 * axis.to), bottom_px + 40.0}, axis.label, "text mid");
  double y_px = kTopPx - kRowPx;
  double from_ms = 0.0;
  int colour = 0;
  for (const std::string& part : parts) {
    const double ms = report.own_median_ms(part);
    if (is_stage(part)) {  // of the bar before
      page.rectangle({x_of(from_ms), y_px, x_of(from_ms + ms) - x_of(from_ms), 20.0}, fmt::format("f{} solid", colour));
      from_ms += ms;
      colour = (colour + 1) % 6;
      continue;
    }
    y_px += kRowPx;
    from_ms = 0.0;
    colour = 0;
    page.rectangle({kLeftPx, y_px, x_of(ms) - kLeftPx, 20.0}, "f5");
    page.text({kLeftPx - 8.0, y_px + 14.0}, part, "text end");
    page.text({x_of(ms) + 6.0, y_px + 14.0}, fmt::format("{:.1f}", ms), "soft halo");
  }
  page.save(file);
}

}  // namespace planemap::benchmark
