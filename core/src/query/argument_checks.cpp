#include "query/argument_checks.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <cstdio>
#include <planemap/query/limits.hpp>

namespace planemap {

namespace {

constexpr double kRotationTolerance = 1e-6;    // of what was written down in floats
constexpr double kCovarianceTolerance = 1e-9;  // of its greatest element

std::optional<Error> wrong(const std::string& name, const std::string& what) {
  std::string message = name;
  message += ": ";
  message += what;
  return Error{std::move(message)};
}

}  // namespace

std::string text_of(double number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", number);
  return text.data();
}

std::optional<Error> check_coordinates(const std::string& name, const Eigen::Vector3d& p_m) {
  if (!p_m.allFinite()) return wrong(name, "not every coordinate is a finite number");
  const double farthest_m = p_m.cwiseAbs().maxCoeff();
  if (farthest_m <= kMaxQueryCoordinateM) return std::nullopt;
  return wrong(name,
               "coordinates may be at most " + text_of(kMaxQueryCoordinateM) + " m, one is " + text_of(farthest_m));
}

std::optional<Error> check_length(const std::string& name, double length_m) {
  if (length_m > 0.0 && length_m <= kMaxQueryCoordinateM) return std::nullopt;
  return wrong(name,
               "must be greater than 0 and at most " + text_of(kMaxQueryCoordinateM) + " m, is " + text_of(length_m));
}

std::optional<Error> check_pose(const std::string& name, const Eigen::Isometry3d& T) {
  if (!T.matrix().allFinite()) return wrong(name, "not every number is finite");
  const Eigen::Matrix3d R = T.linear();
  const double error = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (error > kRotationTolerance || R.determinant() < 0.0) return wrong(name, "its upper left 3x3 is no rotation");
  return check_coordinates(name, T.translation());
}

std::optional<Error> check_covariance(const std::string& name, const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite()) return wrong(name, "not every number is finite");
  const double tolerance = kCovarianceTolerance * covariance.cwiseAbs().maxCoeff();
  if ((covariance - covariance.transpose()).cwiseAbs().maxCoeff() > tolerance) return wrong(name, "is not symmetric");
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance, Eigen::EigenvaluesOnly);
  // The direct solver is good to the root of a double's precision.
  if (solver.eigenvalues().minCoeff() >= -10.0 * tolerance) return std::nullopt;
  return wrong(name, "is not positive semi-definite: its least eigenvalue is " + text_of(solver.eigenvalues()[0]));
}

std::optional<Error> check_filter(const PlaneFilter& filter, const MapSnapshot& snapshot) {
  if (!std::isfinite(filter.min_area_m2) || filter.min_area_m2 < 0.0) {
    return wrong("filter.min_area_m2", "must be finite and at least 0, is " + text_of(filter.min_area_m2));
  }
  if (!(filter.max_normal_deviation_rad >= 0.0)) {
    return wrong("filter.max_normal_deviation_rad",
                 "must be at least 0, is " + text_of(filter.max_normal_deviation_rad));
  }
  if (!filter.epoch || *filter.epoch == snapshot.epoch()) return std::nullopt;
  return wrong("filter.epoch", "the map is of epoch " + std::to_string(snapshot.epoch()) + ", asked for is " +
                                   std::to_string(*filter.epoch));
}

}  // namespace planemap
