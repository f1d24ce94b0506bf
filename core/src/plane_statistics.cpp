#include "planemap/plane_statistics.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace planemap {

namespace {

/// What biases a cell (points of another surface in it, points that went to the cell beside it, noise that the band of
/// its plane cuts off) does the same to those beside it: they err in patches of two by two. Measured on rendered
/// apartments without any other errors: the planes' squared errors are three to four times what cells would make that
/// err each on its own.
constexpr double kCellsOfAPatch = 4.0;

}  // namespace

double PlaneFit::width_m() const {
  return std::sqrt(12.0 * std::max(spread_1_m2, 0.0));
}

double PlaneFit::extent_m() const {
  return std::sqrt(12.0 * std::max(spread_2_m2, 0.0));
}

void PlaneStatistics::accumulate(const Cell& cell, const Eigen::Vector3d& centre_m, double sign, double share) {
  const Eigen::Vector3d shift_m = centre_m - origin_m_;
  const double n = cell.sums.count;
  const Moments evidence = cell.evidence.unpacked();
  pooled_.add(evidence, sign * share, shift_m);
  if (share > 0.0 && evidence.weight > 0.0) {
    means_.add(Symmetric3::outer(shift_m + evidence.mean()), sign * share * evidence.weight);
    core_cells_ += sign;
  }
  const Eigen::Vector3d virtual_centre = cell.sums.mean_m();
  centres_.add(Moments{1.0, virtual_centre, Symmetric3::outer(virtual_centre)}, sign, shift_m);
  if (cell.has_normal()) {
    const auto deviation = static_cast<double>(cell.deviation_rad);
    normal_sum_ += sign * cell.normal.cast<double>();
    deviation_sum_rad2_ += sign * deviation * deviation;
    normals_ += sign;
  }
  view_ += sign * cell.sums.view.cast<double>();
  cells_ += sign;
  points_ += sign * n;
  if (share > 0.0) core_points_ += sign * n;
  evidence_count_ += sign * share * static_cast<double>(cell.evidence_count);
}

void PlaneStatistics::add(const PlaneStatistics& other) {
  const Eigen::Vector3d shift_m = other.origin_m_ - origin_m_;
  const Moments means{other.pooled_.weight, other.pooled_.first, other.means_};
  Moments shifted;
  shifted.add(means, 1.0, shift_m);
  means_.add(shifted.second, 1.0);
  pooled_.add(other.pooled_, 1.0, shift_m);
  centres_.add(other.centres_, 1.0, shift_m);
  normal_sum_ += other.normal_sum_;
  deviation_sum_rad2_ += other.deviation_sum_rad2_;
  normals_ += other.normals_;
  view_ += other.view_;
  cells_ += other.cells_;
  points_ += other.points_;
  core_points_ += other.core_points_;
  evidence_count_ += other.evidence_count_;
  core_cells_ += other.core_cells_;
}

std::optional<PlaneFit> PlaneStatistics::fit(bool pooled) const {
  return pooled ? fit_pooled() : fit_normals();
}

double PlaneStatistics::cells_extent_m() const {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(centres_.covariance(), Eigen::EigenvaluesOnly);
  return std::sqrt(12.0 * std::max(solver.eigenvalues()(2), 0.0));
}

double PlaneStatistics::normal_deviation_rad() const {
  return normals_ > 0.5 ? std::sqrt(std::max(deviation_sum_rad2_, 0.0)) / normals_ : 0.0;  // Eq. 3: S_s / n^2
}

double PlaneStatistics::cell_dispersion(const Plane& plane) const {
  const Moments means{pooled_.weight, pooled_.first, means_};
  const double mean_m2 = means.mean_square_distance(plane.normal(), plane.signed_distance_m(origin_m_));
  return pooled_.weight * std::max(mean_m2, 0.0) / std::max(core_cells_ - 3.0, 1.0);
}

std::optional<PlaneFit> PlaneStatistics::fit_pooled() const {
  if (!(pooled_.weight > 0.0)) return std::nullopt;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(pooled_.covariance());
  const Eigen::Vector3d& spreads = solver.eigenvalues();
  constexpr double kLeastSpread_m2 = 1e-9;
  constexpr double kLeastRatio = 1e-7;  // the solver's own rounding makes a line look a little wide
  if (!(spreads(1) > kLeastSpread_m2 && spreads(1) > kLeastRatio * spreads(2))) return std::nullopt;
  Eigen::Vector3d normal = solver.eigenvectors().col(0).normalized();
  if (normal.dot(view_) < 0.0) normal = -normal;
  const Eigen::Vector3d centroid = origin_m_ + pooled_.mean();
  const Plane plane = Plane::through(centroid, normal);
  return PlaneFit{plane,
                  centroid,
                  solver.eigenvectors().col(1),
                  solver.eigenvectors().col(2),
                  spreads(1),
                  spreads(2),
                  std::max(spreads(0), 0.0),
                  normal_deviation_rad(),
                  pooled_.weight,
                  1.0 / (pooled_.weight * spreads(1)),
                  1.0 / (pooled_.weight * spreads(2)),
                  cell_dispersion(plane)};
}

std::optional<PlaneFit> PlaneStatistics::fit_normals() const {
  if (normals_ < 0.5 || normal_sum_.norm() < 1e-9) return std::nullopt;
  const Eigen::Vector3d normal = normal_sum_.normalized();
  const Eigen::Vector3d centroid = origin_m_ + centres_.mean();
  const Eigen::Matrix3d scatter = centres_.covariance();
  // Principal axes within the plane: of the scatter with its part along the normal taken away.
  const Eigen::Matrix3d into_plane = Eigen::Matrix3d::Identity() - normal * normal.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(into_plane * scatter * into_plane);
  Eigen::Vector3d t2 = into_plane * solver.eigenvectors().col(2);
  if (t2.norm() < 0.5) t2 = normal.unitOrthogonal();  // a single cell spans nothing
  t2.normalize();
  const Eigen::Vector3d t1 = t2.cross(normal);
  // The plane's normal is the mean of its cells', and is as uncertain as Eq. 3 says of a mean.
  const double deviation = normal_deviation_rad();
  return PlaneFit{Plane::through(centroid, normal),
                  centroid,
                  t1,
                  t2,
                  std::max(t1.dot(scatter * t1), 0.0),
                  std::max(t2.dot(scatter * t2), 0.0),
                  normal.dot(scatter * normal),
                  deviation,
                  pooled_.weight,
                  deviation * deviation,
                  deviation * deviation};
}

double squared_chord(double angle_rad) {
  const double chord = 2.0 * std::sin(0.5 * angle_rad);
  return chord * chord;
}

Eigen::Matrix3d sensor_covariance(const PlaneFit& fit, double offset_floor_m) {
  // The normal equations of (tilt_1, tilt_2, offset at the centroid) are diagonal in the principal axes.
  const double floor2 = offset_floor_m * offset_floor_m;
  const auto floor_of_tilt = [&](double spread_m2) {
    constexpr double kLeastHalfExtent2 = 1e-4;  // a single cell has no extent of its own: a centimetre
    return floor2 / std::max(3.0 * spread_m2, kLeastHalfExtent2);  // a uniform strip of half length h varies by h^2 / 3
  };
  const double excess = std::max(1.0, kCellsOfAPatch * fit.cell_dispersion);
  return Eigen::Vector3d(excess * fit.tilt_1_rad2 + floor_of_tilt(fit.spread_1_m2),
                         excess * fit.tilt_2_rad2 + floor_of_tilt(fit.spread_2_m2), excess / fit.weight + floor2)
      .asDiagonal();
}

Eigen::Matrix4d covariance_of(const PlaneFit& fit, const Eigen::Matrix3d& covariance) {
  Eigen::Matrix<double, 4, 3> jacobian;
  jacobian << fit.tangent_1, fit.tangent_2, Eigen::Vector3d::Zero(),  //
      -fit.centroid_m.dot(fit.tangent_1), -fit.centroid_m.dot(fit.tangent_2), 1.0;
  return jacobian * covariance * jacobian.transpose();
}

}  // namespace planemap
