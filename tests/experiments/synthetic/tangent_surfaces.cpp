#include "synthetic/tangent_surfaces.hpp"

#include <numbers>
#include <planemap/assignment.hpp>
#include <planemap/cell_normals.hpp>
#include <random>

namespace planemap::experiments {

namespace {

constexpr std::size_t kScans = 10;
constexpr std::size_t kPointsAScan = 8000;  // about 45 a cell
constexpr double kDegPerRad = 180.0 / std::numbers::pi;

using Random = std::mt19937_64;

double uniform(Random& random, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(random);
}

Eigen::Isometry3d random_placement(Random& random) {
  std::normal_distribution<double> gauss;
  const double w = gauss(random);
  const double x = gauss(random);
  const double y = gauss(random);
  const double z = gauss(random);
  Eigen::Isometry3d placement(Eigen::Quaterniond(w, x, y, z).normalized());
  for (int i = 0; i < 3; ++i) placement.translation()(i) = uniform(random, 0.0, Table::kCellM);
  return placement;
}

/// The cell that Eq. 7 gives a point to, as the code's own assignment of a scan of one point tells.
CellRef taker_of(UncertainGrid& grid, Assigner& assigner, const PointScan& scan, std::size_t point,
                 const Eigen::Isometry3d& T_world_sensor) {
  PointScan one;
  one.xyz_m.assign(scan.xyz_m.begin() + 3 * point, scan.xyz_m.begin() + 3 * point + 3);
  one.sigma_m.assign(scan.sigma_m.begin() + 3 * point, scan.sigma_m.begin() + 3 * point + 3);
  assigner.assign(grid, one, T_world_sensor);
  const CellRef cell = assigner.changes().front().cell;
  assigner.finish(grid);
  return cell;
}

}  // namespace

std::vector<TablePoint> table_points(const Table& table, std::size_t count, double noise_cells, std::uint64_t seed) {
  Random random(seed);
  const Eigen::Vector2d half = 0.5 * table.top_cells;
  const double top_area = table.top_cells.prod();
  const double side_area = table.top_cells.y() * table.side_cells;
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<TablePoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double place = uniform(random, 0.0, top_area + 2.0 * side_area);
    TablePoint point;
    point.surface = place < top_area ? 0 : place < top_area + side_area ? 1 : 2;
    const double y = uniform(random, -half.y(), half.y());
    Eigen::Vector3d p_cells(uniform(random, -half.x(), half.x()), y, 0.0);
    if (point.surface != 0) {
      p_cells = {point.surface == 1 ? -half.x() : half.x(), y, uniform(random, -table.side_cells, 0.0)};
    }
    for (int axis = 0; axis < 3; ++axis) p_cells(axis) += noise_cells * noise(random);
    point.p_m = Table::kCellM * p_cells;
    points.push_back(point);
  }
  return points;
}

Eigen::Isometry3d T_table_sensor() {
  // Two metres away, above and to the left: it sees the top and the left side.
  const Eigen::Vector3d forward = Eigen::Vector3d(0.5, 0.4, -0.75).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << right, forward.cross(right), forward;
  T.translation() = -2.0 * forward;
  return T;
}

PointScan table_scan(const std::vector<TablePoint>& points, double noise_cells) {
  const Eigen::Isometry3d T_sensor_table = T_table_sensor().inverse();
  PointScan scan;
  for (const TablePoint& point : points) {
    const Eigen::Vector3f p = (T_sensor_table * point.p_m).cast<float>();
    scan.xyz_m.insert(scan.xyz_m.end(), {p.x(), p.y(), p.z()});
  }
  scan.sigma_m.assign(scan.xyz_m.size(), static_cast<float>(noise_cells * Table::kCellM));
  return scan;
}

UncertainGrid map_points(const std::vector<PointScan>& scans, const Eigen::Isometry3d& T_world_sensor,
                         const MapperConfig& config) {
  UncertainGrid grid(config.grid.cell_size_m);
  Assigner assigner(config.core, config.sensor, config.grid);
  for (const PointScan& scan : scans) {
    assigner.assign(grid, scan, T_world_sensor);
    for (const CellChange& change : assigner.changes()) {
      Cell& cell = grid.writable(change.cell);
      cell.add(change.added, cell.direction(change.added));
    }
    assigner.finish(grid);
  }
  return grid;
}

CentreDistances centre_distances(const std::vector<PointScan>& scans, const Eigen::Isometry3d& T_world_sensor,
                                 const MapperConfig& config) {
  UncertainGrid grid = map_points(scans, T_world_sensor, config);
  Assigner assigner(config.core, config.sensor, config.grid);
  const PointScan& last = scans.back();
  const std::size_t count = last.xyz_m.size() / 3;
  CentreDistances sum;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d p_m = T_world_sensor * Eigen::Map<const Eigen::Vector3f>(&last.xyz_m[3 * i]).cast<double>();
    const CellRef taker = taker_of(grid, assigner, last, i, T_world_sensor);
    const CellIndex own = grid.index_of(p_m);
    sum.fixed_m += (p_m - grid.geometric_centre_m(own)).norm();
    sum.virtual_m += (p_m - grid.virtual_centre_m(taker)).norm();
    if (grid.index_of(taker) != own) sum.moved += 1.0;
  }
  const auto n = static_cast<double>(count);
  return {sum.fixed_m / n, sum.virtual_m / n, sum.moved / n};
}

double mean_deviation_rad(const UncertainGrid& grid, const MapperConfig& config) {
  NormalEstimator estimator(config.normals);
  double sum_rad = 0.0;
  std::size_t count = 0;
  grid.for_each_cell([&](CellRef ref) {
    if (grid.cell(ref).sums.count <= config.grid.density_threshold) return;
    const auto normal = estimator.fit(grid, ref);
    if (!normal || !std::isfinite(normal->deviation_rad)) return;
    sum_rad += normal->deviation_rad;
    ++count;
  });
  return count > 0 ? sum_rad / static_cast<double>(count) : 0.0;
}

std::vector<Eigen::Isometry3d> along_the_grid() {
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
  placement.translation().setConstant(0.5 * Table::kCellM);
  return {placement};
}

std::vector<Eigen::Isometry3d> turned_at_random(std::size_t count) {
  Random random(7);
  std::vector<Eigen::Isometry3d> placements;
  for (std::size_t i = 0; i < count; ++i) placements.push_back(random_placement(random));
  return placements;
}

NoiseLevel measure_noise_level(double noise_cells, const std::vector<Eigen::Isometry3d>& T_world_table) {
  NoiseLevel level;
  level.noise_cells = noise_cells;
  const double share = 1.0 / static_cast<double>(T_world_table.size());
  for (std::size_t placement = 0; placement < T_world_table.size(); ++placement) {
    const Eigen::Isometry3d T_world_sensor = T_world_table[placement] * T_table_sensor();
    std::vector<PointScan> scans;
    for (std::size_t i = 0; i < kScans; ++i) {
      scans.push_back(table_scan(table_points({}, kPointsAScan, noise_cells, 100 * placement + i), noise_cells));
    }
    MapperConfig config = preset(Preset::kPaper);
    const CentreDistances distances = centre_distances(scans, T_world_sensor, config);
    level.distances.fixed_m += share * distances.fixed_m;
    level.distances.virtual_m += share * distances.virtual_m;
    level.distances.moved += share * distances.moved;
    const UncertainGrid grid = map_points(scans, T_world_sensor, config);
    for (int depth = 1; depth <= 2; ++depth) {
      for (const CentreError error : {CentreError::kMean, CentreError::kPoint}) {
        config.normals.neighbourhood_depth = depth;
        config.normals.centre_error = error;
        level.deviation_deg[depth - 1][error == CentreError::kPoint ? 1 : 0] +=
            share * kDegPerRad * mean_deviation_rad(grid, config);
      }
    }
  }
  return level;
}

}  // namespace planemap::experiments
