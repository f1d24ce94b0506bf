#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <planemap/plane.hpp>

namespace planemap {

/// Variance of n . p + d at a place that is known exactly: (p, 1) C (p, 1)^T, square metres.
inline double offset_variance_m2(const PlaneRecord& record, const Eigen::Vector3d& p_m) {
  const Eigen::Vector4d h = p_m.homogeneous();
  return std::max(h.dot(record.covariance * h), 0.0);
}

/// Variance of the signed distance of an uncertain point: (p, 1) C (p, 1)^T + n^T P n + tr(C_n P). The last term is
/// what both errors make together; with it the variance is exact for independent errors.
inline double distance_variance_m2(const PlaneRecord& record, const Eigen::Vector3d& p_m,
                                   const Eigen::Matrix3d& point_covariance_m2) {
  const Eigen::Vector3d& n = record.plane.normal();
  const double of_both = record.covariance.topLeftCorner<3, 3>().cwiseProduct(point_covariance_m2).sum();
  return offset_variance_m2(record, p_m) + std::max(n.dot(point_covariance_m2 * n) + of_both, 0.0);
}

/// Standard deviation of the range r at which a ray meets the plane in p: r = -(n . o + d) / (n . u), so dr/d(n, d) =
/// -(p, 1) / (n . u). First order: it holds while the normal is known much better than the ray's angle to the plane.
inline double range_sigma_m(const PlaneRecord& record, const Eigen::Vector3d& p_m, double cosine) {
  return std::sqrt(offset_variance_m2(record, p_m)) / std::abs(cosine);
}

}  // namespace planemap
