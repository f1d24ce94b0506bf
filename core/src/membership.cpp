#include "planemap/membership.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace planemap {

double expected_scatter_m2(double centre_m, double cell_size_m, double variance_m2) {
  const double sigma_m = std::sqrt(variance_m2);
  const double low = (std::abs(centre_m) - 0.5 * cell_size_m) / sigma_m;
  const double high = (std::abs(centre_m) + 0.5 * cell_size_m) / sigma_m;
  constexpr double kFar = 3.0;
  if (sigma_m < kLayeredShare * cell_size_m || std::abs(low) > kFar) return variance_m2;
  const auto density = [](double x) { return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi); };
  const auto above = [](double x) { return 0.5 * std::erfc(x / std::numbers::sqrt2); };
  const double share = above(low) - above(high);
  return variance_m2 * (1.0 + (low * density(low) - high * density(high)) / share);
}

bool is_other_surface(const Cell& cell, const Eigen::Vector3d& centre_m, const Plane& plane, double cell_size_m) {
  constexpr double kPureSigmas = 1.5;
  constexpr double kFloor_m = 0.002;  // as planes.core_floor_m: scatter beside the sensor's
  constexpr double kAngle_rad = 0.14;
  constexpr double kOffset_m = 0.02;
  constexpr double kSigmas = 3.0;
  const double variance_m2 = cell.evidence_variance_m2();
  const double noisy_m = 0.5 * kLayeredShare * cell_size_m;
  if (!(variance_m2 < noisy_m * noisy_m)) return false;
  const Moments evidence = cell.evidence.unpacked();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(evidence.covariance());
  const Eigen::Vector3d& spreads_m2 = solver.eigenvalues();
  const double least_m = kLeastPatchSpread * cell_size_m;
  if (spreads_m2(0) > kPureSigmas * kPureSigmas * variance_m2 + kFloor_m * kFloor_m) return false;
  if (spreads_m2(1) < least_m * least_m) return false;
  const double mean_variance_m2 = variance_m2 / static_cast<double>(cell.evidence_count);
  const double angle_rad = std::acos(std::min(1.0, std::abs(solver.eigenvectors().col(0).dot(plane.normal()))));
  if (angle_rad > kAngle_rad + kSigmas * std::sqrt(mean_variance_m2 / spreads_m2(1))) return true;
  const double offset_m = std::abs(plane.signed_distance_m(centre_m + evidence.mean()));
  return offset_m > kOffset_m + kSigmas * std::sqrt(mean_variance_m2);
}

}  // namespace planemap
