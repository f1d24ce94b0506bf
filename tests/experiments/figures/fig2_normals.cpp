#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <planemap/cell_normals.hpp>

#include "figures/figures.hpp"
#include "picture/camera.hpp"
#include "plot/svg_page.hpp"
#include "synthetic/examples.hpp"
#include "synthetic/tangent_surfaces.hpp"

namespace planemap::experiments {

using namespace plot;

namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

void draw_min_max(SvgPage& page, const Box& box, const MinMaxExample& example) {
  const double scale = box.width / 5.0;
  const auto at = [&](const Eigen::Vector2d& cells) {
    const Eigen::Vector2d from_middle = cells - example.middle_cells;
    return Pixel(box.middle() + scale * Pixel(from_middle.x(), -from_middle.y()));
  };
  const auto plane = [&](double tilt_rad, const std::string& classes) {
    const Eigen::Vector2d half = 2.35 * Eigen::Vector2d(std::cos(tilt_rad), std::sin(tilt_rad));
    page.line(at(example.middle_cells - half), at(example.middle_cells + half), classes);
  };
  for (int i = -2; i <= 3; ++i) {
    page.line(at({i, example.middle_cells.y() - 0.7}), at({i, example.middle_cells.y() + 0.7}), "grid");
  }
  plane(example.low_tilt_rad, "s1 dash");
  plane(example.high_tilt_rad, "s2 dash");
  plane(example.tilt_rad, "s0 wide");
  for (const SectionCentre& centre : example.centres) {
    const Pixel p = at(centre.at_cells);
    page.ellipse(p, 4.0, scale * centre.sigma_cells, "f0 pale solid");
    page.circle(at(centre.low_cells), 3.0, "f1 solid");
    page.circle(at(centre.high_cells), 3.0, "f2 solid");
    page.rectangle({p.x() - 4.0, p.y() - 4.0, 8.0, 8.0}, "f0 solid");
  }
}

void legend_of_min_max(SvgPage& page, const Box& box, const MinMaxExample& example) {
  const auto row = [&](double y, const std::string& stroke, const std::string& text) {
    page.line({box.x + 8.0, y - 4.0}, {box.x + 34.0, y - 4.0}, stroke);
    page.text({box.x + 42.0, y}, text);
  };
  row(box.bottom() + 24.0, "s0 wide", "best plane through the virtual centres");
  row(box.bottom() + 44.0, "s1 dash",
      fmt::format("fitted to the centres moved one way: turned by {:.2f}°",
                  kDegPerRad * std::abs(example.low_tilt_rad - example.tilt_rad)));
  row(box.bottom() + 64.0, "s2 dash",
      fmt::format("and the other way: {:.2f}°", kDegPerRad * std::abs(example.high_tilt_rad - example.tilt_rad)));
  page.text(
      {box.x + 8.0, box.bottom() + 90.0},
      fmt::format("the normal's deviation by the code's closed form: {:.2f}°", kDegPerRad * example.deviation_rad),
      "text head");
}

/// A dense cell of the table with its uncertain normal.
struct DrawnNormal {
  Eigen::Vector3d centre_m;
  UncertainNormal normal;
};

std::vector<DrawnNormal> normals_of_table(const Table& table, double noise_cells) {
  MapperConfig config = preset(Preset::kPaper);
  config.grid.density_threshold = 60;
  config.normals.centre_error = CentreError::kPoint;
  std::vector<PointScan> scans;
  for (std::uint64_t i = 0; i < 5; ++i)
    scans.push_back(table_scan(table_points(table, 4000, noise_cells, i), noise_cells));
  Eigen::Isometry3d T_world_table = Eigen::Isometry3d::Identity();
  T_world_table.translation() = 0.5 * Eigen::Vector3d::Constant(Table::kCellM);
  const UncertainGrid grid = map_points(scans, T_world_table * T_table_sensor(), config);
  NormalEstimator estimator(config.normals);
  std::vector<DrawnNormal> drawn;
  grid.for_each_cell([&](CellRef ref) {
    if (grid.cell(ref).sums.count <= config.grid.density_threshold) return;
    const Eigen::Vector3d in_table_m = grid.virtual_centre_m(ref) - T_world_table.translation();
    const bool is_far_side = in_table_m.x() > 2.0 * Table::kCellM && in_table_m.z() < -0.5 * Table::kCellM;
    if (is_far_side) return;  // one would look at it through the top
    if (const auto normal = estimator.fit(grid, ref)) drawn.push_back({grid.virtual_centre_m(ref), *normal});
  });
  return drawn;
}

/// The wire frame of a cone about a normal, from the virtual centre; its half angle is the deviation.
void draw_cone(SvgPage& page, const PageFit& place, const DrawnNormal& cell, double length_m,
               const std::string& series) {
  const Eigen::Vector3d u = cell.normal.normal.unitOrthogonal();
  const Eigen::Vector3d v = cell.normal.normal.cross(u);
  const double radius_m = length_m * std::tan(std::min(cell.normal.deviation_rad, 1.0));
  std::vector<Pixel> rim;
  constexpr int kSides = 12;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSides;
    rim.push_back(
        place(cell.centre_m + length_m * cell.normal.normal + radius_m * (std::cos(angle) * u + std::sin(angle) * v)));
  }
  page.polygon(rim, "s" + series + " f" + series + " pale thin");
  const Pixel tip = place(cell.centre_m);
  // The outline of a cone: the rays to the rim's points that are farthest to each side.
  const Pixel along = place(cell.centre_m + length_m * cell.normal.normal) - tip;
  const auto side = [&](const Pixel& p) { return along.x() * (p - tip).y() - along.y() * (p - tip).x(); };
  const auto [low, high] =
      std::minmax_element(rim.begin(), rim.end(), [&](const Pixel& a, const Pixel& b) { return side(a) < side(b); });
  page.polyline(std::array<Pixel, 3>{*low, tip, *high}, "s" + series + " thin");
}

void draw_uncertain_normals(SvgPage& page, const Box& box, std::vector<DrawnNormal> cells) {
  const Camera camera(Eigen::Vector3d::UnitZ(), 1.17 * std::numbers::pi, 0.62);
  std::vector<Eigen::Vector3d> extent;
  for (const DrawnNormal& cell : cells) {
    extent.push_back(cell.centre_m);
    extent.push_back(cell.centre_m + 0.07 * cell.normal.normal);
  }
  const PageFit place(camera, extent, box);
  std::sort(cells.begin(), cells.end(), [&](const DrawnNormal& a, const DrawnNormal& b) {
    return camera.nearness(a.centre_m) < camera.nearness(b.centre_m);
  });
  for (const DrawnNormal& cell : cells) {
    if (cell.normal.normal.dot(camera.towards()) < 0.05) continue;
    const Pixel at = place(cell.centre_m);
    draw_cone(page, place, cell, 0.055, "1");
    page.arrow(at, place(cell.centre_m + 0.07 * cell.normal.normal), "s0 thin", "f0 solid");
    page.rectangle({at.x() - 2.5, at.y() - 2.5, 5.0, 5.0}, "f0 solid");
  }
}

}  // namespace

FigureResult draw_fig2(const std::filesystem::path& folder) {
  constexpr double kNoiseCells = 0.1;
  const MinMaxExample example = min_max_example();
  const std::vector<DrawnNormal> cells = normals_of_table({{5.0, 4.0}, 3.0}, kNoiseCells);
  SvgPage page(
      960.0, 520.0, "Fig. 2: uncertain normals",
      "Squares are virtual centres. (a): bars are standard errors; (b): the half angle of a cone is the deviation.");
  page.text({24.0, 88.0}, "(a) min-max approach, a section of 5 x 5 cells", "text head");
  page.text({500.0, 88.0}, "(b) normals of the table of Fig. 4, noise 0.1 of a cell", "text head");
  const Box left{24.0, 120.0, 440.0, 200.0};
  draw_min_max(page, left, example);
  legend_of_min_max(page, {left.x, left.y, left.width, left.height + 10.0}, example);
  draw_uncertain_normals(page, {520.0, 110.0, 410.0, 380.0}, cells);
  FigureResult result;
  result.numbers = {{"refitTurnDeg",
                     {kDegPerRad * std::abs(example.low_tilt_rad - example.tilt_rad),
                      kDegPerRad * std::abs(example.high_tilt_rad - example.tilt_rad)}},
                    {"deviationDeg", kDegPerRad * example.deviation_rad}};
  result.lines.push_back(fmt::format(
      "planes fitted to the perturbed centres turn by {:.2f} and {:.2f} deg; min_max_deviation_rad: {:.2f} deg",
      kDegPerRad * std::abs(example.low_tilt_rad - example.tilt_rad),
      kDegPerRad * std::abs(example.high_tilt_rad - example.tilt_rad), kDegPerRad * example.deviation_rad));
  result.files.push_back(folder / "fig2.svg");
  page.save(result.files.back());
  return result;
}

}  // namespace planemap::experiments
