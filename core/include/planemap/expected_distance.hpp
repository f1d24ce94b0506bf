#pragma once

#include <Eigen/Core>

namespace planemap {

/// What Eq. 2 to 7 need of a cell: n, L about a reference point, and S_s.
struct CentreStatistics {
  double count = 0.0;                                ///< n = d(u)
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  ///< L
  Eigen::Vector3d error = Eigen::Vector3d::Zero();   ///< S_s
};

/// E[C_u] = L / n; Eq. 1 with E[eps] = 0. @pre count > 0
inline Eigen::Vector3d expected_centre(const CentreStatistics& u) {
  return u.linear / u.count;
}

/// S_s / n^2, summed over the axes: what the errors add to E|C_u|^2. @pre count > 0
inline double centre_variance(const CentreStatistics& u) {
  return u.error.sum() / (u.count * u.count);
}

/// E|C_u|^2 = L^2 / n^2 + S_s / n^2; Eq. 3 (Eq. 2 in statistics). @pre count > 0
inline double expected_squared_norm(const CentreStatistics& u) {
  return expected_centre(u).squaredNorm() + centre_variance(u);
}

/// E|p|^2 = p^2 + eps^2; Eq. 5.
/// @param variance  squared standard errors of p along the axes
inline double expected_squared_norm(const Eigen::Vector3d& p, const Eigen::Vector3d& variance) {
  return p.squaredNorm() + variance.sum();
}

/// E|p - C_u|^2; Eq. 7 (Eq. 4 in statistics), with Eq. 6 for the mixed term. Differs from the paper: the squares of p,
/// L/n and their product are kept together as |p - L/n|^2, since the expanded form loses its digits far from the
/// origin.
/// @param variance  squared standard errors of p along the axes
inline double expected_squared_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& variance,
                                        const CentreStatistics& u) {
  return (p - expected_centre(u)).squaredNorm() + variance.sum() + centre_variance(u);
}

}  // namespace planemap
