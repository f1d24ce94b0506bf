#include "planemap/pose_covariance.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace planemap {

namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

}  // namespace

PoseCovariance configured_covariance(const PoseErrorConfig& config) {
  Eigen::Matrix<double, 6, 1> variances;
  variances.head<3>().setConstant(config.sigma_m * config.sigma_m);
  variances.tail<3>().setConstant(config.sigma_rad * config.sigma_rad);
  return variances.asDiagonal();
}

PoseCovariance covariance_at_sensor(const PoseCovariance& of_body, const Eigen::Isometry3d& T_body_sensor) {
  const Eigen::Isometry3d T_sensor_body = T_body_sensor.inverse();
  PoseCovariance adjoint = PoseCovariance::Zero();
  adjoint.topLeftCorner<3, 3>() = T_sensor_body.linear();
  adjoint.bottomRightCorner<3, 3>() = T_sensor_body.linear();
  adjoint.topRightCorner<3, 3>() = cross_matrix(T_sensor_body.translation()) * T_sensor_body.linear();
  return adjoint * of_body * adjoint.transpose();
}

PoseCovariance cholesky_factor(const PoseCovariance& x) {
  // Where a row hangs on those before it, what is left of its variance is rounding: it gets no column of its own.
  constexpr double kRounding = 1e-12;
  PoseCovariance rest = x;
  PoseCovariance factor = PoseCovariance::Zero();
  for (int column = 0; column < 6; ++column) {
    if (!(rest(column, column) > kRounding * x(column, column))) continue;
    const int rows = 6 - column;
    factor.col(column).tail(rows) = rest.col(column).tail(rows) / std::sqrt(rest(column, column));
    rest -= factor.col(column) * factor.col(column).transpose();
  }
  return factor;
}

double point_variance_m2(const PoseCovariance& of_sensor) {
  constexpr double kUsualRangeM = 2.5;
  Eigen::Matrix<double, 3, 6> motion;  // of the point (0, 0, range): t + r x p
  motion << Eigen::Matrix3d::Identity(), -cross_matrix({0.0, 0.0, kUsualRangeM});
  return greatest_variance(motion * of_sensor * motion.transpose());
}

double greatest_variance(const Eigen::Matrix3d& covariance) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues()(2);
}

}  // namespace planemap
