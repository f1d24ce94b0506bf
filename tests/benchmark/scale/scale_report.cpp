#include "scale/scale_report.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <plot/chart.hpp>
#include <vector>

#include "common/machine.hpp"

namespace planemap::benchmark {

namespace {

using Value = double (*)(const ScaleWindow&);

std::vector<plot::Datum> series(std::span<const ScaleWindow> windows, Value value) {
  std::vector<plot::Datum> data;
  data.reserve(windows.size());
  for (const ScaleWindow& window : windows) data.emplace_back(window.area_m2, value(window));
  return data;
}

struct Curve {
  const char* name;
  Value value;
};

void draw(plot::SvgPage& page, const plot::Box& box, const std::string& head, const std::string& unit,
          std::span<const ScaleWindow> windows, std::span<const Curve> curves) {
  double greatest = 0.0;
  for (const Curve& curve : curves) {
    for (const ScaleWindow& window : windows) greatest = std::max(greatest, curve.value(window));
  }
  plot::Chart chart(page, box, head, plot::axis_from_zero("map, m² of floor", windows.back().area_m2),
                    plot::axis_from_zero(unit, 1.4 * greatest));
  for (std::size_t i = 0; i < curves.size(); ++i) {
    chart.line(series(windows, curves[i].value), fmt::format("s{}", i));
    chart.legend(fmt::format("f{} solid", i), curves[i].name);
  }
}

}  // namespace

ScaleRatio scale_ratio(std::span<const ScaleWindow> windows) {
  constexpr double kLargeM2 = 9000.0;
  ScaleRatio result;
  double sum = 0.0;
  int count = 0;
  for (const ScaleWindow& window : windows) {
    if (window.ratio() <= 0.0) continue;
    result.ratio = window.ratio();
    if (window.area_m2 < kLargeM2) continue;
    sum += window.ratio();
    ++count;
  }
  if (count > 0) result.ratio = sum / count;
  if (!windows.empty()) result.area_m2 = windows.back().area_m2;
  return result;
}

std::string scale_table_head() {
  return " scans   floor    cells  blocks planes | scan ms    p95    own  / twin | publish    p95    own max own |"
         " take ms    p95    max |   RSS    a cell\n"
         "            m2                        |                            |                               |"
         "                        |    MB         B\n";
}

std::string scale_table_row(const ScaleWindow& w) {
  return fmt::format(
      "{:6} {:7.0f} {:8} {:7} {:6} | {:7.2f} {:6.2f} {:6.2f} {:7.2f} | {:7.3f} {:6.3f} {:6.3f} {:7.3f} | {:7.4f} "
      "{:6.4f} "
      "{:6.3f} | {:5.0f} {:9.0f}\n",
      w.scans, w.area_m2, w.cells, w.blocks, w.planes, w.scan_ms, w.scan_p95_ms, w.own_ms, w.ratio(), w.publish_ms,
      w.publish_p95_ms, w.publish_own_ms, w.publish_own_max_ms, w.take_ms, w.take_p95_ms, w.take_max_ms, w.rss_mb,
      1e6 * w.rss_mb / static_cast<double>(w.cells));
}

std::string scale_json(std::span<const ScaleWindow> windows) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const ScaleWindow& w : windows) {
    rows.push_back({{"scans", w.scans},
                    {"areaM2", w.area_m2},
                    {"cells", w.cells},
                    {"blocks", w.blocks},
                    {"planes", w.planes},
                    {"scanMs", {{"median", w.scan_ms}, {"p95", w.scan_p95_ms}, {"own", w.own_ms}}},
                    {"twinOwnMs", w.twin_own_ms},
                    {"ratio", w.ratio()},
                    {"publishMs",
                     {{"median", w.publish_ms},
                      {"p95", w.publish_p95_ms},
                      {"own", w.publish_own_ms},
                      {"maxOwn", w.publish_own_max_ms}}},
                    {"takeMs", {{"median", w.take_ms}, {"p95", w.take_p95_ms}, {"max", w.take_max_ms}}},
                    {"rssMb", w.rss_mb}});
  }
  const ScaleRatio ratio = scale_ratio(windows);
  const nlohmann::ordered_json report = {{"windows", std::move(rows)},
                                         {"ratio", ratio.ratio},
                                         {"areaM2", ratio.area_m2},
                                         {"machine", json_of(this_machine())}};
  return report.dump(2);
}

void draw_scale(std::span<const ScaleWindow> windows, const std::filesystem::path& file) {
  plot::SvgPage page(960.0, 800.0, "What a scan costs, however large the map",
                     fmt::format("{} scans of a simulated building; medians over {} scans, one thread",
                                 windows.back().scans, windows.front().scans));
  const Curve time[] = {{"large map, all scans", [](const ScaleWindow& w) { return w.own_ms; }},
                        {"map of 100 m², 150 of these scans", [](const ScaleWindow& w) { return w.twin_own_ms; }}};
  const Curve ratio[] = {{"large map / map of 100 m²", [](const ScaleWindow& w) { return w.ratio(); }}};
  const Curve memory[] = {{"resident memory", [](const ScaleWindow& w) { return w.rss_mb; }}};
  const Curve snapshot[] = {{"the mapper publishes one", [](const ScaleWindow& w) { return w.publish_own_ms; }},
                            {"a reader takes one", [](const ScaleWindow& w) { return w.take_ms; }}};
  draw(page, {84.0, 100.0, 376.0, 260.0}, "(a) time of a scan, the thread's own", "ms", windows, time);
  draw(page, {564.0, 100.0, 376.0, 260.0}, "(b) ratio", "ratio", windows, ratio);
  draw(page, {84.0, 470.0, 376.0, 260.0}, "(c) memory", "MB", windows, memory);
  draw(page, {564.0, 470.0, 376.0, 260.0}, "(d) snapshots", "ms", windows, snapshot);
  page.save(file);
}

}  // namespace planemap::benchmark
