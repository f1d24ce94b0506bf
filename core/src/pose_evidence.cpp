#include "planemap/pose_evidence.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdlib>

namespace planemap {

namespace {

/// sum w a a^T with a = (p - origin, 1).
Eigen::Matrix4d homogeneous(const Moments& moments) {
  Eigen::Matrix4d m;
  m << moments.second.matrix(), moments.first, moments.first.transpose(), moments.weight;
  return m;
}

/// G of g(p) = G a: what a pose's error does to a point's distance to the plane. To first order the point moves by
/// R (t + r x p_sensor), so its distance by n.R t + r . (p_sensor x R^T n).
Eigen::Matrix<double, 6, 4> leverage(const Eigen::Vector3d& normal, const Eigen::Vector3d& origin_m,
                                     const Eigen::Isometry3d& T_world_sensor) {
  Eigen::Matrix<double, 6, 4> g = Eigen::Matrix<double, 6, 4>::Zero();
  const Eigen::Matrix3d R = T_world_sensor.linear();
  const Eigen::Vector3d arm_m = origin_m - T_world_sensor.translation();
  g.block<3, 1>(0, 3) = R.transpose() * normal;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d turned = normal.cross(R.col(axis));  // e . (q x n) = q . (n x e)
    g.block<1, 3>(3 + axis, 0) = turned.transpose();
    g(3 + axis, 3) = turned.dot(arm_m);
  }
  return g;
}

}  // namespace

void PoseEvidence::pass_time(std::int64_t utime, const PoseErrorConfig& config) {
  const double elapsed_s = 1e-6 * static_cast<double>(std::llabs(utime - utime_));
  carried_ *= config.correlation_s > 0.0 ? std::exp(-elapsed_s / config.correlation_s) : 0.0;
  utime_ = utime;
}

void PoseEvidence::update(const Moments& held, const Eigen::Vector3d& normal, const Eigen::Vector3d& origin_m,
                          const ScanPose& scan, const PoseErrorConfig& config) {
  const Eigen::Matrix4d m = homogeneous(held) - normal_equations_;
  const Matrix46 b =
      m * leverage(normal, origin_m, scan.T_world_sensor).transpose() * cholesky_factor(scan.covariance_or(config));
  pass_time(scan.utime, config);
  const Eigen::Matrix4d shared = b * carried_.transpose();
  spread_ += b * b.transpose() + shared + shared.transpose();
  carried_ += b;
  normal_equations_ += m;
}

void PoseEvidence::add(const PoseEvidence& other, const Eigen::Vector3d& shift_m, const PoseErrorConfig& config) {
  Eigen::Matrix4d to_ours = Eigen::Matrix4d::Identity();  // a = to_ours * (the other's a)
  to_ours.block<3, 1>(0, 3) = shift_m;
  const Eigen::Matrix4d their_spread = to_ours * other.spread_ * to_ours.transpose();
  // The covariance of a sum is at most (1 + r) of one and (1 + 1/r) of the other, for any r: here the r that is best
  // for the offset, whose element does not depend on the origin.
  const double ours = spread_(3, 3);
  const double theirs = their_spread(3, 3);
  if (ours > 0.0 && theirs > 0.0) {
    const double r = std::sqrt(theirs / ours);
    spread_ = (1.0 + r) * spread_ + (1.0 + 1.0 / r) * their_spread;
  } else {
    spread_ += their_spread;
  }
  PoseEvidence late = other;
  if (utime_ > late.utime_) late.pass_time(utime_, config);
  if (late.utime_ > utime_) pass_time(late.utime_, config);
  carried_ += to_ours * late.carried_;
  normal_equations_ += to_ours * other.normal_equations_ * to_ours.transpose();
}

Eigen::Matrix3d PoseEvidence::covariance(const PlaneFit& fit, const Eigen::Vector3d& origin_m,
                                         const PoseCovariance& of_one_scan) const {
  const Eigen::Vector3d centroid = fit.centroid_m - origin_m;
  Eigen::Matrix<double, 3, 4> to_fit;                                 // from a to (u, v, 1) about the centroid
  to_fit << fit.tangent_1.transpose(), -fit.tangent_1.dot(centroid),  //
      fit.tangent_2.transpose(), -fit.tangent_2.dot(centroid),        //
      0.0, 0.0, 0.0, 1.0;
  const Eigen::Matrix3d equations = to_fit * normal_equations_ * to_fit.transpose();
  const double weight = equations(2, 2);
  const bool spans = weight > 0.0 && fit.spread_1_m2 > 0.0 && fit.spread_2_m2 > 0.0;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  constexpr double kLeastShare = 1e-3;  // of the fit's own spreads: the evidence must span the plane as the fit does
  if (spans) {
    const Eigen::Vector3d scale(1.0 / std::sqrt(fit.spread_1_m2), 1.0 / std::sqrt(fit.spread_2_m2), 1.0);
    solver.computeDirect(scale.asDiagonal() * equations * scale.asDiagonal() / weight);
  }
  if (!spans || !(solver.eigenvalues()(0) > kLeastShare)) {
    const double rotation = greatest_variance(of_one_scan.bottomRightCorner<3, 3>());
    return Eigen::Vector3d(rotation, rotation, greatest_variance(of_one_scan.topLeftCorner<3, 3>())).asDiagonal();
  }
  const Eigen::Matrix3d inverse = equations.inverse();
  return inverse * to_fit * spread_ * to_fit.transpose() * inverse;
}

}  // namespace planemap
