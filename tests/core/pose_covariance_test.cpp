#include "planemap/pose_covariance.hpp"

#include <gtest/gtest.h>

#include <random>

namespace planemap {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Of errors as large along all axes as a good visual odometry's, and all correlated.
PoseCovariance some_covariance(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  PoseCovariance root;
  for (double& value : root.reshaped()) value = 0.003 * normal(random);
  return root * root.transpose();
}

Isometry3d motion_of(const Vector6d& error) {
  Isometry3d motion = Isometry3d::Identity();
  motion.translation() = error.head<3>();
  const Vector3d turn = error.tail<3>();
  if (turn.norm() > 0.0) motion.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  return motion;
}

TEST(PoseCovariance, ALeverArmTurnsRotationIntoTranslation) {
  // The sensor is 2 m before the body and looks as the body does: what turns the body about z by r moves the sensor
  // along y by 2 r, and both are one error.
  PoseCovariance body = PoseCovariance::Zero();
  body(5, 5) = 9e-6;
  Isometry3d T_body_sensor = Isometry3d::Identity();
  T_body_sensor.translation().x() = 2.0;
  PoseCovariance expected = PoseCovariance::Zero();
  expected(5, 5) = 9e-6;
  expected(1, 1) = 36e-6;
  expected(1, 5) = expected(5, 1) = 18e-6;
  EXPECT_TRUE(covariance_at_sensor(body, T_body_sensor).isApprox(expected, 1e-12))
      << covariance_at_sensor(body, T_body_sensor);
}

TEST(PoseCovariance, AxesOfTheSensorAreItsOwn) {
  // Optical axes on a body with x forward, y left, z up: the sensor's z is the body's x, its x the body's -y.
  Isometry3d T_body_sensor = Isometry3d::Identity();
  T_body_sensor.linear() = Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5).toRotationMatrix();
  Vector6d variances;
  variances << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0;
  Vector6d expected;
  expected << 2.0, 3.0, 1.0, 5.0, 6.0, 4.0;
  const PoseCovariance sensor = covariance_at_sensor(variances.asDiagonal(), T_body_sensor);
  EXPECT_TRUE(sensor.isApprox(PoseCovariance(expected.asDiagonal()), 1e-12)) << sensor;
}

TEST(PoseCovariance, AtTheSensorIsTheScatterOfDisturbedBodies) {
  const PoseCovariance body = some_covariance(3);
  const PoseCovariance factor = cholesky_factor(body);
  Isometry3d T_body_sensor = Isometry3d::Identity();
  T_body_sensor.translation() = Vector3d(0.4, -0.7, 1.1);
  T_body_sensor.linear() = Eigen::AngleAxisd(1.2, Vector3d(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  constexpr int kTrials = 20000;
  PoseCovariance scatter = PoseCovariance::Zero();
  for (int trial = 0; trial < kTrials; ++trial) {
    Vector6d z;
    for (double& value : z) value = normal(random);
    const Isometry3d error = T_body_sensor.inverse() * motion_of(factor * z) * T_body_sensor;
    const Eigen::AngleAxisd turn(error.rotation());
    Vector6d x;
    x << error.translation(), turn.angle() * turn.axis();
    scatter += x * x.transpose() / kTrials;
  }
  const PoseCovariance stated = covariance_at_sensor(body, T_body_sensor);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      EXPECT_NEAR(scatter(i, j), stated(i, j), 0.04 * std::sqrt(stated(i, i) * stated(j, j))) << i << j;
    }
  }
}

TEST(PoseCovariance, TheFactorGivesTheCovarianceBack) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const PoseCovariance x = some_covariance(seed);
    const PoseCovariance factor = cholesky_factor(x);
    EXPECT_TRUE((factor * factor.transpose()).isApprox(x, 1e-12)) << seed;
    EXPECT_TRUE(factor.isLowerTriangular());
  }
}

TEST(PoseCovariance, TheFactorOfASingularOneGivesItBack) {
  // A robot that drives on a floor errs along x and y and about z; and its error about z hangs on that along y.
  PoseCovariance x = PoseCovariance::Zero();
  x(0, 0) = 4e-6;
  x(1, 1) = 9e-6;
  x(1, 5) = x(5, 1) = 3e-6;
  x(5, 5) = 1e-6;
  const PoseCovariance factor = cholesky_factor(x);
  EXPECT_TRUE((factor * factor.transpose()).isApprox(x, 1e-12)) << factor;
  EXPECT_NEAR(factor(0, 0), 2e-3, 1e-15);
  EXPECT_NEAR(factor(5, 1), 1e-3, 1e-15);
  EXPECT_EQ(factor(5, 5), 0.0);
  EXPECT_TRUE(cholesky_factor(PoseCovariance::Zero()).isZero(0.0));
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    PoseCovariance root = some_covariance(seed);
    root.rightCols<3>().setZero();
    const PoseCovariance flat = root * root.transpose();
    const PoseCovariance of_flat = cholesky_factor(flat);
    EXPECT_TRUE((of_flat * of_flat.transpose()).isApprox(flat, 1e-9)) << seed;
  }
}

TEST(PoseCovariance, APointErrsByThePositionAndTheTurn) {
  PoseErrorConfig config;
  config.sigma_m = 0.004;
  config.sigma_rad = 0.002;
  // At 2.5 m: 4^2 + (2.5 * 2)^2 square millimetres.
  EXPECT_NEAR(point_variance_m2(configured_covariance(config)), 41e-6, 1e-15);
  PoseCovariance x = PoseCovariance::Zero();
  x(2, 2) = 1e-6;
  x(3, 3) = 4e-6;  // about x: moves the point along y
  EXPECT_NEAR(point_variance_m2(x), 25e-6, 1e-15);
  // The turn about x by r moves it by -2.5 r along y: an error along y of 2.5 r takes that back.
  x(1, 1) = 25e-6;
  x(1, 3) = x(3, 1) = 10e-6;
  EXPECT_NEAR(point_variance_m2(x), 1e-6, 1e-15);
}

}  // namespace
}  // namespace planemap
