#include <spdlog/fmt/fmt.h>

#include "figures/figures.hpp"
#include "plot/svg_page.hpp"
#include "synthetic/examples.hpp"

namespace planemap::experiments {

using namespace plot;

namespace {

constexpr double kCellPixels = 170.0;

/// Two by two cells on a page.
class Layer {
 public:
  Layer(SvgPage& page, const Pixel& corner, const std::string& head) : page_(page), corner_(corner) {
    page.text(corner + Pixel(0.0, -12.0), head, "text head");
    for (int i = 0; i <= 2; ++i) {
      page.line(at({i, 0.0}), at({i, 2.0}), "axis");
      page.line(at({0.0, i}), at({2.0, i}), "axis");
    }
  }
  Pixel at(const Eigen::Vector2d& cells) const { return corner_ + kCellPixels * Pixel(cells.x(), 2.0 - cells.y()); }
  void ellipse(const Eigen::Vector2d& at_cells, const Eigen::Vector2d& sigma_cells, const std::string& classes) {
    page_.ellipse(at(at_cells), kCellPixels * sigma_cells.x(), kCellPixels * sigma_cells.y(), classes);
  }
  void square(const Eigen::Vector2d& at_cells, const std::string& classes) {
    const Pixel p = at(at_cells);
    page_.rectangle({p.x() - 5.0, p.y() - 5.0, 10.0, 10.0}, classes);
  }
  /// An arrow that leaves room at both of its ends.
  void arrow(const Eigen::Vector2d& from_cells, const Eigen::Vector2d& to_cells, const std::string& stroke_class,
             const std::string& fill_class) {
    const Pixel from = at(from_cells);
    const Pixel to = at(to_cells);
    const Pixel along = (to - from).normalized();
    page_.arrow(from + 7.0 * along, to - 8.0 * along, stroke_class, fill_class);
  }

 private:
  SvgPage& page_;
  Pixel corner_;
};

void draw_points(Layer& layer, const AssignmentExample& example, bool uncertain, SvgPage& page) {
  for (const FlatPoint& point : example.points) {
    if (uncertain) layer.ellipse(point.p_cells, point.sigma_cells, "f5 pale solid");
    page.circle(layer.at(point.p_cells), 3.0, "f5 solid");
  }
  if (uncertain) layer.ellipse(example.next.p_cells, example.next.sigma_cells, "f3 pale s3 thin");
  page.circle(layer.at(example.next.p_cells), 4.5, "f3 solid");
}

void label_distance(SvgPage& page, const Layer& layer, const AssignmentExample& example, const Rival& rival) {
  const Eigen::Vector2d along = rival.virtual_cells - example.next.p_cells;
  const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized();
  const Eigen::Vector2d at = example.next.p_cells + 0.55 * along + (rival.wins ? -0.13 : 0.085) * across;
  page.text(layer.at(at) + Pixel(0.0, 4.0), fmt::format("{:.2f}", rival.expected_cells), "text mid halo");
}

}  // namespace

FigureResult draw_fig1(const std::filesystem::path& folder) {
  const AssignmentExample example = assignment_example();
  SvgPage page(800.0, 520.0, "Fig. 1: mapping a point to the grid",
               "One layer of the grid, from above. Distances in units of the cell; ellipses are standard errors.");
  Layer fixed(page, {40.0, 104.0}, "(a) without uncertainty: the cell it lies in");
  Layer uncertain(page, {420.0, 104.0}, "(b) with uncertainty: least of Eq. 7");
  draw_points(fixed, example, false, page);
  draw_points(uncertain, example, true, page);
  FigureResult result;
  for (const Rival& rival : example.rivals) {
    fixed.square(rival.fixed_cells, "s1 wide");
    if (rival.holds) fixed.arrow(example.next.p_cells, rival.fixed_cells, "s1 wide", "f1 solid");
    uncertain.ellipse(rival.virtual_cells, rival.sigma_cells, "s0 thin");
    uncertain.square(rival.virtual_cells, rival.wins ? "f0 s0 wide" : "s0 wide");
    uncertain.arrow(example.next.p_cells, rival.virtual_cells, rival.wins ? "s0 fat" : "s0 thin dash", "f0 solid");
    label_distance(page, uncertain, example, rival);
    result.numbers["cells"].push_back({{"cell", {rival.cell.x(), rival.cell.y()}},
                                       {"expectedDistanceCells", rival.expected_cells},
                                       {"pointLiesInIt", rival.holds},
                                       {"pointGoesToIt", rival.wins}});
    result.lines.push_back(fmt::format(
        "cell ({}, {}): expected distance {:.3f} of a cell{}{}", rival.cell.x(), rival.cell.y(), rival.expected_cells,
        rival.holds ? ", the point lies in it" : "", rival.wins ? ", takes the point" : ""));
  }
  const double y = 480.0;
  page.circle({48.0, y - 4.0}, 3.0, "f5 solid");
  page.text({58.0, y}, "points of the cells");
  page.circle({198.0, y - 4.0}, 4.5, "f3 solid");
  page.text({209.0, y}, "the new point");
  page.rectangle({308.0, y - 9.0, 10.0, 10.0}, "s1 wide");
  page.text({326.0, y}, "fixed centre");
  page.rectangle({428.0, y - 9.0, 10.0, 10.0}, "s0 wide");
  page.text({446.0, y}, "virtual centre (Eq. 1); filled: takes the point");
  result.files.push_back(folder / "fig1.svg");
  page.save(result.files.back());
  return result;
}

}  // namespace planemap::experiments
