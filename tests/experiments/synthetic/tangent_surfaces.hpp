#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <planemap/config.hpp>
#include <planemap/scan.hpp>
#include <planemap/uncertain_grid.hpp>
#include <vector>

namespace planemap::experiments {

/// The paper's synthetic data (section V.A): three tangent surfaces that form a table, a top on two upright sides. Its
/// frame: x along the top, y across it, z up; the top's middle is the origin.
struct Table {
  Eigen::Vector2d top_cells{10.0, 8.0};  ///< length and width, in units of the cell
  double side_cells = 6.0;               ///< height of the sides

  static constexpr double kCellM = 0.08;  ///< the paper's cell
};

/// One noisy point of the table.
struct TablePoint {
  Eigen::Vector3d p_m;  ///< table frame
  int surface = 0;      ///< 0 the top, 1 and 2 the sides
};

/// Points spread evenly over the surfaces, each moved by Gaussian noise along each axis.
/// @param noise_cells  its standard deviation, in units of the cell
std::vector<TablePoint> table_points(const Table& table, std::size_t count, double noise_cells, std::uint64_t seed);

/// The points as a sensor in front of the table sees them, which knows their standard errors.
PointScan table_scan(const std::vector<TablePoint>& points, double noise_cells);
/// Where that sensor is in the table's frame.
Eigen::Isometry3d T_table_sensor();

/// Assigns scans by Eq. 7, one after the other, all from one pose, and adds them up (Fig. 3, lines 2 and 3).
UncertainGrid map_points(const std::vector<PointScan>& scans, const Eigen::Isometry3d& T_world_sensor,
                         const MapperConfig& config);

/// How far points are from the centres that stand for them.
struct CentreDistances {
  double fixed_m = 0.0;    ///< mean distance to the middle of the cube that the point lies in
  double virtual_m = 0.0;  ///< mean distance to the virtual centre of the cell that Eq. 7 gives it to
  double moved = 0.0;      ///< share of the points that Eq. 7 gives to another cell than their own
};

/// Maps the scans, then measures the points of the last one (Fig. 5).
CentreDistances centre_distances(const std::vector<PointScan>& scans, const Eigen::Isometry3d& T_world_sensor,
                                 const MapperConfig& config);

/// Mean deviation (Definition 3) of the normals of all dense cells, radians.
double mean_deviation_rad(const UncertainGrid& grid, const MapperConfig& config);

/// One level of noise, as Fig. 5 and the text beside it have it.
struct NoiseLevel {
  double noise_cells = 0.0;
  CentreDistances distances;  ///< mean over the placements
  /// Mean deviation of the normals, degrees: by depth d - 1 (Definition 2), then by whose error perturbs a centre: 0
  /// that of the mean of its points, 1 that of one point (NormalConfig::centre_error).
  double deviation_deg[2][2] = {};
};

/// Where the table stands in the world: along the grid, its surfaces in the middle of layers of cells.
std::vector<Eigen::Isometry3d> along_the_grid();
/// Or turned and shifted at random; the same ones each time.
std::vector<Eigen::Isometry3d> turned_at_random(std::size_t count);

/// Measures one level of noise, as the mean over placements.
/// @param T_world_table  the placements
NoiseLevel measure_noise_level(double noise_cells, const std::vector<Eigen::Isometry3d>& T_world_table);

}  // namespace planemap::experiments
