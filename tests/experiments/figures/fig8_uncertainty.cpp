#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "figures/figures.hpp"
#include "figures/map_faces.hpp"
#include "picture/camera.hpp"
#include "plot/svg_page.hpp"

namespace planemap::experiments {

using namespace plot;

namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr int kShades = 8;
constexpr double kElevationRad = 0.62;

// Dark where the normal is sure, bright red where it is not; on dark pages the sure ones are a lighter slate.
constexpr const char* kLightShades =
    ".u0{fill:#20242f}.u1{fill:#3a2a33}.u2{fill:#582c33}.u3{fill:#7a2c31}.u4{fill:#9e2b2d}.u5{fill:#c22a28}"
    ".u6{fill:#e32a22}.u7{fill:#ff3b2a}.q{stroke:none}\n";
constexpr const char* kDarkShades =
    ".u0{fill:#5a6478}.u1{fill:#66596a}.u2{fill:#75505c}.u3{fill:#8a474e}.u4{fill:#a53f41}.u5{fill:#c33a36}"
    ".u6{fill:#e4382f}.u7{fill:#ff4a38}\n";

struct Scale {
  double least_rad;
  double greatest_rad;
  int shade_of(double rad) const {
    const double place = std::log(rad / least_rad) / std::log(greatest_rad / least_rad);
    return std::clamp(static_cast<int>(place * kShades), 0, kShades - 1);
  }
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// What is drawn as one square: a cell, or the mean of those of one plane in a cube of several cells where there are
/// too many of them for a small file.
std::vector<CellView> thinned(const std::vector<CellView>& cells, double edge_m) {
  std::map<std::array<long, 4>, std::vector<const CellView*>> cubes;
  for (const CellView& cell : cells) {
    const Eigen::Array3d i = (cell.centre_m.array() / edge_m).floor();
    cubes[{std::lround(i.x()), std::lround(i.y()), std::lround(i.z()), static_cast<long>(cell.plane_id)}].push_back(
        &cell);
  }
  std::vector<CellView> kept;
  for (const auto& [place, members] : cubes) {
    CellView mean = *members.front();
    mean.centre_m.setZero();
    mean.deviation_rad = 0.0;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (const CellView* cell : members) {
      mean.centre_m += cell->centre_m / static_cast<double>(members.size());
      mean.deviation_rad += cell->deviation_rad / static_cast<double>(members.size());
      normal += *cell->normal;
    }
    if (normal.norm() < 0.1) continue;
    mean.normal = normal.normalized();
    kept.push_back(mean);
  }
  return kept;
}

/// Squares of a cell's size about the centres, back to front in slices, each slice one path a shade. Corners are whole
/// half pixels from one to the next, which keeps the file small.
void draw_cells(SvgPage& page, const Camera& camera, const PageFit& place, std::vector<CellView> cells, double size_m,
                const Scale& scale) {
  std::sort(cells.begin(), cells.end(), [&](const CellView& a, const CellView& b) {
    return camera.nearness(a.centre_m) < camera.nearness(b.centre_m);
  });
  page.raw("<g transform=\"scale(.5)\">\n");
  std::array<std::string, kShades> paths;
  std::array<Eigen::Vector2i, kShades> last;
  const auto flush = [&] {
    for (int shade = 0; shade < kShades; ++shade) {
      std::string& path = paths[static_cast<std::size_t>(shade)];
      if (!path.empty()) page.raw(fmt::format("<path class=\"q u{}\" d=\"{}\"/>\n", shade, path));
      path.clear();
    }
    last.fill(Eigen::Vector2i::Zero());
  };
  flush();
  double slice_end = cells.empty() ? 0.0 : camera.nearness(cells.front().centre_m) + size_m;
  for (const CellView& cell : cells) {
    if (camera.nearness(cell.centre_m) > slice_end) {
      flush();
      slice_end = camera.nearness(cell.centre_m) + size_m;
    }
    const auto shade = static_cast<std::size_t>(scale.shade_of(cell.deviation_rad));
    const PlaneBasis basis = basis_of(Plane::through(cell.centre_m, *cell.normal), cell.centre_m);
    Eigen::Vector2i from = last[shade];
    constexpr std::array<std::array<double, 2>, 4> kCorners = {{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}};
    for (std::size_t i = 0; i < kCorners.size(); ++i) {
      const Pixel p = 2.0 * place(basis.to_world(size_m * Eigen::Vector2d(kCorners[i][0], kCorners[i][1])));
      const Eigen::Vector2i to(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
      paths[shade] += fmt::format("{}{}{}{}",
                                  i == 0   ? "m"
                                  : i == 1 ? "l"
                                           : " ",
                                  to.x() - from.x(), to.y() - from.y() < 0 ? "" : " ", to.y() - from.y());
      if (i == 0) last[shade] = to;
      from = to;
    }
    paths[shade] += 'z';
  }
  flush();
  page.raw("</g>\n");
}

/// A cell is at an edge where fewer than six of the cells around it are in its plane.
std::vector<bool> at_edge(const std::vector<CellView>& cells, double size_m) {
  std::map<std::array<int, 3>, std::vector<PlaneId>> places;
  const auto key = [&](const Eigen::Vector3d& p) {
    const Eigen::Array3i i = (p.array() / size_m).floor().cast<int>();
    return std::array<int, 3>{i.x(), i.y(), i.z()};
  };
  for (const CellView& cell : cells) places[key(cell.centre_m)].push_back(cell.plane_id);
  std::vector<bool> edge;
  for (const CellView& cell : cells) {
    const std::array<int, 3> middle = key(cell.centre_m);
    long around = -1;  // itself
    for (int i = 0; i < 27; ++i) {
      const auto found = places.find({middle[0] + i % 3 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i / 9 - 1});
      if (found != places.end()) around += std::count(found->second.begin(), found->second.end(), cell.plane_id);
    }
    edge.push_back(cell.plane_id == kNoPlane || around < 6);
  }
  return edge;
}

void draw_legend(SvgPage& page, const Pixel& at, const Scale& scale) {
  constexpr double kWidth = 34.0;
  for (int shade = 0; shade < kShades; ++shade) {
    page.rectangle({at.x() + kWidth * shade, at.y(), kWidth, 12.0}, fmt::format("q u{}", shade));
  }
  for (int i = 0; i <= kShades; i += 2) {
    const double deg =
        kDegPerRad * scale.least_rad * std::pow(scale.greatest_rad / scale.least_rad, static_cast<double>(i) / kShades);
    page.text({at.x() + kWidth * i, at.y() + 28.0}, fmt::format("{:.2g}°", deg), "soft mid");
  }
}

/// Deviations in degrees of all cells, by where they are.
struct Deviations {
  std::vector<double> all;
  std::array<std::vector<double>, 2> by_edge;      ///< within planes, and at their edges or in none
  std::array<std::vector<double>, 2> by_distance;  ///< nearer to where the sensor went than the median, and farther
  double median_m = 0.0;                           ///< of that distance
};

Deviations deviations_of(const std::vector<CellView>& cells, double size_m,
                         const std::vector<Eigen::Vector3d>& sensors_m) {
  Deviations result;
  const std::vector<bool> edge = at_edge(cells, size_m);
  std::vector<double> distances_m;
  for (const CellView& cell : cells) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& sensor : sensors_m) nearest_m = std::min(nearest_m, (sensor - cell.centre_m).norm());
    distances_m.push_back(nearest_m);
  }
  result.median_m = quantile(distances_m, 0.5);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double deg = kDegPerRad * cells[i].deviation_rad;
    result.all.push_back(deg);
    result.by_edge[edge[i] ? 1 : 0].push_back(deg);
    result.by_distance[distances_m[i] > result.median_m ? 1 : 0].push_back(deg);
  }
  return result;
}

}  // namespace

FigureResult draw_fig8(const std::filesystem::path& folder, const SceneRun& scene) {
  const PresetRun& run = scene.paper();
  std::vector<CellView> cells;
  run.map->for_each_cell([&](const CellView& cell) {
    if (cell.normal && cell.deviation_rad > 0.0 && std::isfinite(cell.deviation_rad)) cells.push_back(cell);
  });
  const double size_m = run.map->cell_size_m();
  const Deviations found = deviations_of(cells, size_m, scene.sensors_m);
  const Scale scale{quantile(found.all, 0.05) / kDegPerRad, quantile(found.all, 0.97) / kDegPerRad};
  SvgPage page(
      960.0, 720.0, "Fig. 8: uncertainty of the normals, " + scene.title,
      fmt::format("{} dense cells of preset paper; what turns away from the viewer is left out.", cells.size()));
  page.style(kLightShades, kDarkShades);
  const double azimuth_rad = best_azimuth_rad(scene.up, kElevationRad, faces_of(*run.map, 0.1).faces);
  const Camera camera(scene.up, azimuth_rad, kElevationRad);
  std::erase_if(cells, [&](const CellView& cell) { return cell.normal->dot(camera.towards()) < 0.05; });
  constexpr std::size_t kMostSquares = 10000;
  double edge_m = size_m;
  for (int edge_cells = 2; cells.size() > kMostSquares; edge_cells *= 2) {
    edge_m = edge_cells * size_m;
    cells = thinned(cells, edge_m);
  }
  if (edge_m > size_m) {
    page.text({940.0, 676.0}, fmt::format("one square for the cells of a plane in {:.2f} m", edge_m), "soft end");
  }
  std::vector<Eigen::Vector3d> extent;
  for (const CellView& cell : cells) extent.push_back(cell.centre_m);
  draw_cells(page, camera, PageFit(camera, extent, {40.0, 80.0, 880.0, 560.0}), cells, edge_m, scale);
  draw_legend(page, {40.0, 664.0}, scale);
  FigureResult result;
  result.lines.push_back(
      fmt::format("median deviation: {:.3f} deg within planes, {:.3f} deg at their edges and outside of them",
                  quantile(found.by_edge[0], 0.5), quantile(found.by_edge[1], 0.5)));
  result.lines.push_back(fmt::format(
      "{:.3f} deg in the half of the cells that the sensor came near, {:.3f} deg in the others (farther than {:.2f} m)",
      quantile(found.by_distance[0], 0.5), quantile(found.by_distance[1], 0.5), found.median_m));
  result.numbers = {{"cells", found.all.size()},
                    {"medianDeg",
                     {{"inside", quantile(found.by_edge[0], 0.5)},
                      {"edge", quantile(found.by_edge[1], 0.5)},
                      {"near", quantile(found.by_distance[0], 0.5)},
                      {"far", quantile(found.by_distance[1], 0.5)}}},
                    {"farM", found.median_m},
                    {"paper", "cells at edges of planes and far from the robot are less certain"}};
  result.files.push_back(folder / ("fig8-" + scene.name + ".svg"));
  page.save(result.files.back());
  return result;
}

}  // namespace planemap::experiments
