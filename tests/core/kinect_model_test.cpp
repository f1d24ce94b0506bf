#include "planemap/kinect_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace planemap {
namespace {

SensorConfig without_quantisation() {
  SensorConfig config;
  config.disparity_step_px = 0.0;
  return config;
}

TEST(KinectModel, DepthErrorGrowsWithTheSquareOfDepth) {
  const KinectModel model(without_quantisation(), 585.0);
  EXPECT_NEAR(model.sigma_z_m(1.0), 1.425e-3, 1e-12);
  EXPECT_NEAR(model.sigma_z_m(2.0), 5.7e-3, 1e-12);
  EXPECT_NEAR(model.sigma_z_m(5.0), 35.625e-3, 1e-12);
}

TEST(KinectModel, QuantisationOfTheDisparityAddsItsVariance) {
  // A step of 1/8 pixel is z^2 * 0.125 / (585 * 0.075) in depth: 2.8490e-3 m at 1 m; over sqrt(12): 0.82244e-3 m.
  const KinectModel model(SensorConfig{}, 585.0);
  EXPECT_NEAR(model.sigma_z_m(1.0), std::hypot(1.425e-3, 0.82244e-3), 1e-8);
}

TEST(KinectModel, LateralErrorIsInProportionToTheOffsetFromTheAxis) {
  const KinectModel model(without_quantisation(), 585.0);
  // sigma_x = x / z * sigma_z = 1.5 / 3 * 1.425e-3 * 9.
  EXPECT_NEAR(model.sigma_lateral_m(1.5, 3.0), 0.5 * 1.425e-3 * 9.0, 1e-12);
  EXPECT_NEAR(model.sigma_lateral_m(-1.5, 3.0), 0.5 * 1.425e-3 * 9.0, 1e-12);
}

TEST(KinectModel, LateralErrorIsAtLeastHalfAPixel) {
  const KinectModel model(without_quantisation(), 500.0);
  EXPECT_NEAR(model.sigma_lateral_m(0.0, 2.0), 0.5 / 500.0 * 2.0, 1e-12);
}

TEST(KinectModel, RejectsAFocalLengthThatIsNone) {
  EXPECT_THROW(KinectModel(SensorConfig{}, 0.0), std::invalid_argument);
  EXPECT_THROW(KinectModel(SensorConfig{}, std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
}

TEST(RotateVariances, QuarterTurnSwapsTheAxes) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_TRUE(rotate_variances(R, {1.0, 2.0, 3.0}).isApprox(Eigen::Vector3d(1.0, 3.0, 2.0), 1e-12));
}

TEST(RotateVariances, IsTheDiagonalOfTheRotatedCovariance) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::Vector3d variance(0.1, 0.2, 0.9);
  const Eigen::Matrix3d rotated = R * variance.asDiagonal() * R.transpose();
  EXPECT_TRUE(rotate_variances(R, variance).isApprox(rotated.diagonal(), 1e-12));
}

}  // namespace
}  // namespace planemap
