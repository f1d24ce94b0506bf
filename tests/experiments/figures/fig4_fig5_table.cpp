#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "figures/figures.hpp"
#include "picture/camera.hpp"
#include "plot/chart.hpp"
#include "plot/svg_page.hpp"
#include "synthetic/tangent_surfaces.hpp"

namespace planemap::experiments {

using namespace plot;

namespace {

constexpr std::array kLevels = {0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5};  // of a cell
constexpr std::size_t kPlacements = 6;

std::vector<NoiseLevel> all_levels(const std::vector<Eigen::Isometry3d>& placements) {
  std::vector<NoiseLevel> levels;
  for (const double noise_cells : kLevels) levels.push_back(measure_noise_level(noise_cells, placements));
  return levels;
}

/// All points of one surface as one path of dots.
void draw_dots(SvgPage& page, const PageFit& place, const std::vector<TablePoint>& points, int surface) {
  std::string path = fmt::format("<path class=\"s{}\" stroke-width=\"2.2\" stroke-opacity=\".75\" d=\"",
                                 std::array{0, 2, 3}[static_cast<std::size_t>(surface)]);
  for (const TablePoint& point : points) {
    if (point.surface != surface) continue;
    const Pixel p = place(point.p_m);
    path += fmt::format("M{:.0f} {:.0f}h0", p.x(), p.y());
  }
  page.raw(path + "\"/>\n");
}

/// One way to read what the paper does not say of its normals.
struct Reading {
  int depth;           ///< d of Definition 2
  int error;           ///< that perturbs a centre: 0 that of the mean of its points, 1 that of one point
  const char* series;  ///< on the chart
};
constexpr std::array kReadings = {Reading{1, 1, "2"}, Reading{1, 0, "3"}, Reading{2, 1, "0"}, Reading{2, 0, "4"}};

/// Draws a reading's deviations over the noise and notes those that the paper has numbers for.
void add_reading(const Reading& reading, const std::vector<NoiseLevel>& levels, bool along, Chart& chart,
                 FigureResult& result) {
  std::vector<Datum> data;
  for (const NoiseLevel& level : levels) {
    if (level.noise_cells <= 0.3)
      data.emplace_back(level.noise_cells, level.deviation_deg[reading.depth - 1][reading.error]);
  }
  const auto deg_at = [&](double noise_cells) {
    return std::find_if(data.begin(), data.end(), [&](const Datum& d) { return d.x() == noise_cells; })->y();
  };
  const std::string name =
      fmt::format("d = {}, error of {}", reading.depth, reading.error == 1 ? "one point" : "the mean");
  chart.line(data, fmt::format("s{} {}", reading.series, along ? "wide" : "dash"));
  if (along) chart.legend(fmt::format("f{} solid", reading.series), name);
  result.lines.push_back(fmt::format("{}, {:24}: {:5.2f} deg at 0.1, {:5.2f} deg at 0.2, ratio {:.2f}",
                                     along ? "along the grid" : "turned        ", name, deg_at(0.1), deg_at(0.2),
                                     deg_at(0.2) / deg_at(0.1)));
  result.numbers[along ? "alongTheGrid" : "turned"].push_back({{"depth", reading.depth},
                                                               {"centreError", reading.error == 1 ? "point" : "mean"},
                                                               {"deg", {{"0.1", deg_at(0.1)}, {"0.2", deg_at(0.2)}}},
                                                               {"ratio", deg_at(0.2) / deg_at(0.1)}});
}

}  // namespace

FigureResult draw_fig4(const std::filesystem::path& folder) {
  SvgPage page(960.0, 400.0, "Fig. 4: three tangent surfaces that form a table",
               "A top of 10 x 8 cells on two sides of 8 x 6 cells; the noise of the points in units of the cell.");
  const Camera camera(Eigen::Vector3d::UnitZ(), 1.17 * std::numbers::pi, 0.5);
  std::vector<Eigen::Vector3d> extent;
  for (const TablePoint& point : table_points({}, 2000, 0.5, 3)) extent.push_back(point.p_m);
  double x = 24.0;
  for (const double noise_cells : {0.0, 0.1, 0.5}) {
    const PageFit place(camera, extent, {x, 100.0, 290.0, 275.0});
    page.text({x, 88.0}, fmt::format("noise {:g}", noise_cells), "text head");
    const std::vector<TablePoint> points = table_points({}, 3500, noise_cells, 3);
    for (const int surface : {2, 0, 1}) draw_dots(page, place, points, surface);
    x += 310.0;
  }
  FigureResult result;
  result.files.push_back(folder / "fig4.svg");
  result.lines.push_back("the table at noise 0, 0.1 and 0.5 of a cell");
  page.save(result.files.back());
  return result;
}

FigureResult draw_fig5(const std::filesystem::path& folder) {
  SvgPage page(640.0, 450.0, "Fig. 5: distance of the points to the centres of their cells",
               fmt::format("Solid: the table stands along the grid. Dashed: {} tables turned and shifted at random.",
                           kPlacements));
  Chart chart(page, {84.0, 100.0, 520.0, 290.0}, "", {"noise of the points, units of the cell", 0.0, 0.5},
              axis_from_zero("mean distance, units of the cell", 0.6));
  FigureResult result;
  for (const bool along : {true, false}) {
    std::vector<Datum> fixed;
    std::vector<Datum> moving;
    for (const NoiseLevel& level : all_levels(along ? along_the_grid() : turned_at_random(kPlacements))) {
      fixed.emplace_back(level.noise_cells, level.distances.fixed_m / Table::kCellM);
      moving.emplace_back(level.noise_cells, level.distances.virtual_m / Table::kCellM);
      const double moved = level.distances.moved;
      result.lines.push_back(fmt::format(
          "{}, noise {:4.2f}: fixed {:.3f}, virtual {:.3f} of a cell; {:4.1f} % of the points go to another cell",
          along ? "along the grid" : "turned", level.noise_cells, fixed.back().y(), moving.back().y(), 100.0 * moved));
      result.numbers[along ? "alongTheGrid" : "turned"].push_back({{"noiseCells", level.noise_cells},
                                                                   {"fixedCells", fixed.back().y()},
                                                                   {"virtualCells", moving.back().y()},
                                                                   {"movedShare", moved}});
    }
    chart.line(fixed, along ? "s1 wide" : "s1 dash");
    chart.line(moving, along ? "s0 wide" : "s0 dash");
    if (!along) continue;
    chart.marks(fixed, "f1 solid");
    chart.marks(moving, "f0 solid");
  }
  chart.legend("f1 solid", "fixed centres, point to the cell it lies in");
  chart.legend("f0 solid", "virtual centres, point to the cell by Eq. 7");
  result.files.push_back(folder / "fig5.svg");
  page.save(result.files.back());
  return result;
}

FigureResult draw_normals(const std::filesystem::path& folder) {
  const std::array paper_deg = {Datum(0.1, 3.82), Datum(0.2, 7.34)};
  SvgPage page(640.0, 430.0, "Deviation of the normals over the noise of the points",
               "Mean of all dense cells, min-max approach. Solid: table along the grid; dashed: turned at random.");
  Chart chart(page, {84.0, 100.0, 520.0, 270.0}, "", {"noise of the points, units of the cell", 0.0, 0.3},
              axis_from_zero("deviation, degrees", 25.0));
  FigureResult result;
  result.numbers["paperDeg"] = {{"0.1", 3.82}, {"0.2", 7.34}, {"ratio", 7.34 / 3.82}};
  for (const bool along : {true, false}) {
    const std::vector<NoiseLevel> levels = all_levels(along ? along_the_grid() : turned_at_random(kPlacements));
    for (const Reading& reading : kReadings) add_reading(reading, levels, along, chart, result);
  }
  chart.marks(paper_deg, "f1 solid");
  chart.legend("f1 solid", "the paper: 3.82° and 7.34°");
  result.lines.push_back("the paper: 3.82 deg at 0.1, 7.34 deg at 0.2, ratio 1.92");
  result.files.push_back(folder / "normals.svg");
  page.save(result.files.back());
  return result;
}

}  // namespace planemap::experiments
