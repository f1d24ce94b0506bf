#include "synthetic/examples.hpp"

#include <cmath>
#include <planemap/assignment.hpp>
#include <planemap/cell_normals.hpp>
#include <planemap/expected_distance.hpp>
#include <stdexcept>

#include "synthetic/tangent_surfaces.hpp"

namespace planemap::experiments {

namespace {

constexpr double kCellM = 0.08;
constexpr double kLayerCells = 13.5;  // middle of a layer of cells within the sensor's range

void append(PointScan& scan, const Eigen::Vector3d& p_cells, const Eigen::Vector3d& sigma_cells) {
  for (int axis = 0; axis < 3; ++axis) {
    scan.xyz_m.push_back(static_cast<float>(kCellM * p_cells(axis)));
    scan.sigma_m.push_back(static_cast<float>(kCellM * sigma_cells(axis)));
  }
}

void append(PointScan& scan, const FlatPoint& point) {
  append(scan, {point.p_cells.x(), point.p_cells.y(), kLayerCells},
         {point.sigma_cells.x(), point.sigma_cells.y(), 0.0});
}

MapperConfig paper_with_cells_of_8_cm() {
  MapperConfig config = preset(Preset::kPaper);
  config.grid.cell_size_m = kCellM;
  return config;
}

Rival rival_of(const UncertainGrid& grid, const CellIndex& index, const FlatPoint& next) {
  const CellRef ref = grid.find(index).value();
  const CellSums& sums = grid.cell(ref).sums;
  // The cell's statistics (Definition 1) about its geometric centre, and the point from there, too.
  const CentreStatistics statistics{sums.count, sums.first_m, sums.error_m2.cast<double>()};
  const Eigen::Vector3d p_m =
      kCellM * Eigen::Vector3d(next.p_cells.x(), next.p_cells.y(), kLayerCells) - grid.geometric_centre_m(ref);
  const Eigen::Vector2d sigma_m = kCellM * next.sigma_cells;
  const Eigen::Vector3d variance_m2(sigma_m.x() * sigma_m.x(), sigma_m.y() * sigma_m.y(), 0.0);
  Rival rival;
  rival.cell = index;
  rival.fixed_cells = grid.geometric_centre_m(ref).head<2>() / kCellM;
  rival.virtual_cells = grid.virtual_centre_m(ref).head<2>() / kCellM;
  rival.sigma_cells = (sums.error_m2.head<2>().cast<double>().cwiseSqrt() / sums.count) / kCellM;
  rival.expected_cells = std::sqrt(expected_squared_distance(p_m, variance_m2, statistics)) / kCellM;
  rival.holds =
      grid.index_of(Eigen::Vector3d(kCellM * Eigen::Vector3d(next.p_cells.x(), next.p_cells.y(), kLayerCells))) ==
      index;
  return rival;
}

/// The plane fitted to one point a cell, and its deviation: the normal of the cell in the middle.
UncertainNormal fit_patch(const PointScan& scan) {
  MapperConfig config = paper_with_cells_of_8_cm();
  config.normals.neighbourhood_depth = 2;
  const UncertainGrid grid = map_points({scan}, Eigen::Isometry3d::Identity(), config);
  const CellRef middle = grid.find({0, 0, static_cast<int>(std::floor(kLayerCells))}).value();
  const auto normal = NormalEstimator(config.normals).fit(grid, middle);
  if (!normal) throw std::logic_error("the patch of Fig. 2 spans no plane");
  return *normal;
}

/// The tilt of a plane in the section along x; its normal points to the sensor, down the page.
double tilt_rad_of(const UncertainNormal& fit) {
  return std::atan2(fit.normal.x(), -fit.normal.z());
}

}  // namespace

AssignmentExample assignment_example() {
  AssignmentExample example;
  example.points = {{{0.20, 0.25}, {0.05, 0.09}}, {{0.32, 0.52}, {0.06, 0.05}}, {{0.14, 0.44}, {0.04, 0.06}},
                    {{0.38, 0.22}, {0.07, 0.05}}, {{1.08, 0.60}, {0.06, 0.04}}, {{1.22, 0.80}, {0.05, 0.07}},
                    {{1.17, 0.46}, {0.04, 0.05}}, {{1.36, 0.66}, {0.08, 0.05}}, {{0.52, 1.72}, {0.06, 0.08}},
                    {{0.74, 1.84}, {0.05, 0.05}}, {{0.33, 1.60}, {0.09, 0.05}}, {{1.60, 1.52}, {0.12, 0.14}},
                    {{1.78, 1.34}, {0.10, 0.12}}, {{1.52, 1.74}, {0.14, 0.10}}};
  example.next = {{0.84, 0.56}, {0.10, 0.07}};
  const MapperConfig config = paper_with_cells_of_8_cm();
  PointScan seen;
  for (const FlatPoint& point : example.points) append(seen, point);
  UncertainGrid grid = map_points({seen}, Eigen::Isometry3d::Identity(), config);
  PointScan next;
  append(next, example.next);
  Assigner assigner(config.core, config.sensor, config.grid);
  assigner.assign(grid, next, Eigen::Isometry3d::Identity());
  const CellIndex winner = grid.index_of(assigner.changes().front().cell);
  assigner.finish(grid);
  const int layer = static_cast<int>(std::floor(kLayerCells));
  for (const CellIndex& index :
       {CellIndex(0, 0, layer), CellIndex(1, 0, layer), CellIndex(0, 1, layer), CellIndex(1, 1, layer)}) {
    example.rivals.push_back(rival_of(grid, index, example.next));
    example.rivals.back().wins = index == winner;
  }
  return example;
}

MinMaxExample min_max_example() {
  // Five rows of five cells with one point each; all rows are alike, so the section along x tells the whole. They are a
  // little closer to each other along x, so that the plane turns most about y.
  constexpr double kPitchCells = 0.93;
  constexpr double kHeights[5] = {-0.02, -0.12, 0.03, 0.0, 0.12};
  constexpr double kSigmas[5] = {0.16, 0.10, 0.07, 0.12, 0.19};
  const auto place = [&](int i) { return Eigen::Vector2d(0.5 + kPitchCells * (i - 2), kLayerCells + kHeights[i]); };
  const auto patch = [&](const auto& moved) {
    PointScan scan;
    for (int j = 0; j < 5; ++j) {
      for (int i = 0; i < 5; ++i) {
        const Eigen::Vector2d p = moved(i);
        append(scan, {p.x(), 0.5 + (j - 2), p.y()}, {0.0, 0.0, kSigmas[i]});
      }
    }
    return fit_patch(scan);
  };
  const UncertainNormal fit = patch(place);
  MinMaxExample example;
  example.tilt_rad = tilt_rad_of(fit);
  example.deviation_rad = fit.deviation_rad;
  example.middle_cells = Eigen::Vector2d::Zero();
  for (int i = 0; i < 5; ++i) example.middle_cells += place(i) / 5.0;
  const Eigen::Vector2d along(std::cos(example.tilt_rad), std::sin(example.tilt_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  // Each centre goes along the normal by its error, to the side that turns the plane most.
  const auto moved = [&](int i, double way) {
    const double t = along.dot(place(i) - example.middle_cells);
    return Eigen::Vector2d(place(i) + way * std::copysign(kSigmas[i] * std::abs(across.y()), t) * across);
  };
  example.high_tilt_rad = tilt_rad_of(patch([&](int i) { return moved(i, 1.0); }));
  example.low_tilt_rad = tilt_rad_of(patch([&](int i) { return moved(i, -1.0); }));
  for (int i = 0; i < 5; ++i) example.centres.push_back({place(i), kSigmas[i], moved(i, -1.0), moved(i, 1.0)});
  return example;
}

}  // namespace planemap::experiments
