// Poses that state their covariance; those that do not are in scan_codec_test.cpp.
#include "codec/pose_codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "codec/fingerprint.hpp"
#include "support/messages.hpp"

namespace planemap::service {
namespace {

using pronto::rigid_body_pose_cov_t;

/// The element of pose_cov for two of (chi x, y, z, position x, y, z).
double& element(rigid_body_pose_cov_t& message, int row, int column) {
  return message.pose_cov[6 * row + column];
}

TEST(PoseCovCodec, FingerprintIsThatOfTheField) {
  EXPECT_EQ(fingerprint_of(encoded(rigid_body_pose_cov_t{})), 0x2b9733583b090550U);
  EXPECT_EQ(encoded(rigid_body_pose_cov_t{}).size(), 366u);
}

TEST(PoseCovCodec, PoseComesBack) {
  auto message = pose_cov_message(77, 1.5, 0.01, 0.002);
  message.xyz_pos[2] = -0.5;
  message.quat[0] = message.quat[3] = 0.7071;
  const auto pose = decode_pose(encoded(message));
  ASSERT_TRUE(pose) << pose.error().message;
  EXPECT_EQ(pose->utime, 77);
  EXPECT_EQ(pose->p_world_m, Eigen::Vector3d(1.5, 0.0, -0.5));
  EXPECT_NEAR((pose->q_world_body * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-12);
}

TEST(PoseCovCodec, TheCovarianceIsTurnedToTheBodysAxes) {
  // The body has turned by a right angle about z: the world's x is the body's -y, the world's y its x.
  auto message = pose_cov_message(77, 0.0, 0.0, 0.0);
  message.quat[0] = message.quat[3] = std::sqrt(0.5);
  element(message, 0, 0) = 1e-6;  // chi x, about the body's own
  element(message, 1, 1) = 4e-6;
  element(message, 2, 2) = 9e-6;
  element(message, 3, 3) = 16e-6;  // position along the world's x
  element(message, 4, 4) = 25e-6;
  element(message, 5, 5) = 36e-6;
  element(message, 2, 3) = element(message, 3, 2) = 3e-6;
  const auto pose = decode_pose(encoded(message));
  ASSERT_TRUE(pose) << pose.error().message;
  PoseCovariance expected = PoseCovariance::Zero();
  expected.diagonal() << 25e-6, 16e-6, 36e-6, 1e-6, 4e-6, 9e-6;
  expected(1, 5) = expected(5, 1) = -3e-6;
  EXPECT_TRUE(pose->covariance.value().isApprox(expected, 1e-12)) << *pose->covariance;
}

TEST(PoseCovCodec, ACovarianceOfAllZerosStatesNothing) {
  const auto pose = decode_pose(encoded(pose_cov_message(77, 1.5, 0.0, 0.0)));
  ASSERT_TRUE(pose) << pose.error().message;
  EXPECT_FALSE(pose->covariance);
}

TEST(PoseCovCodec, WhatSinglePrecisionLeavesIsMendedTowardsTheGreater) {
  // A robot that turns about a point 0.7 m behind: its position hangs on its yaw, the matrix is singular.
  auto message = pose_cov_message(77, 0.0, 0.0, 0.0);
  const double lever_m = 0.7;
  const auto single = [](double x) { return static_cast<double>(static_cast<float>(x)); };
  element(message, 2, 2) = single(1.1e-5);
  element(message, 4, 4) = single(1.1e-5 * lever_m * lever_m);
  element(message, 2, 4) = element(message, 4, 2) = single(1.1e-5 * lever_m) * (1.0 + 1e-7);
  const auto pose = decode_pose(encoded(message));
  ASSERT_TRUE(pose) << pose.error().message;
  const PoseCovariance& x = pose->covariance.value();
  EXPECT_GE(x(5, 5) * x(1, 1), x(1, 5) * x(1, 5));
  EXPECT_NEAR(x(5, 5), 1.1e-5, 1e-11);
  const PoseCovariance factor = cholesky_factor(x);
  EXPECT_TRUE((factor * factor.transpose()).isApprox(x, 1e-9));
}

TEST(PoseCovCodec, RejectsWhatIsNoPoseOrNoCovariance) {
  struct Case {
    const char* reason;
    std::function<void(rigid_body_pose_cov_t&)> spoil;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const Case cases[] = {
      {"time", [](auto& m) { m.utime = -1; }},
      {"not_finite", [](auto& m) { m.xyz_pos[2] = kNan; }},
      {"quaternion", [](auto& m) { m.quat[1] = 0.5; }},
      {"partial", [](auto& m) { m.active_indices[3] = 0; }},
      {"partial", [](auto& m) { m.active_indices[3] = -1; }},
      {"not_finite", [](auto& m) { element(m, 0, 0) = kNan; }},
      {"not_finite", [](auto& m) { element(m, 5, 2) = kInfinite; }},
      {"covariance", [](auto& m) { element(m, 4, 4) = -1e-12; }},
      {"covariance", [](auto& m) { element(m, 1, 3) = 1e-7; }},                          // no mirror image
      {"covariance", [](auto& m) { element(m, 1, 3) = element(m, 3, 1) = 2.1e-5; }},     // correlation 1.05
      {"covariance", [](auto& m) { element(m, 1, 3) = element(m, 3, 1) = 1e300; }},      //
      {"covariance", [](auto& m) { element(m, 3, 3) = 0.0, element(m, 3, 4) = 1e-9; }},  // without a variance
      {"covariance",                                                                     // three of -0.6: none, though
       [](auto& m) {                                                                     // each two would be one
         for (const auto& [i, j] : {std::pair{3, 4}, std::pair{4, 5}, std::pair{3, 5}}) {
           element(m, i, j) = element(m, j, i) = -0.6e-4;
         }
       }},
      {"uncertain", [](auto& m) { element(m, 3, 3) = 101.0; }},
      {"uncertain", [](auto& m) { element(m, 2, 2) = 1.01; }},
  };
  for (const auto& c : cases) {
    auto message = pose_cov_message(5, 0.0, 0.01, 0.002);
    ASSERT_TRUE(decode_pose(encoded(message)));
    c.spoil(message);
    const auto pose = decode_pose(encoded(message));
    ASSERT_FALSE(pose) << &c - cases;
    EXPECT_EQ(pose.error().reason, c.reason) << pose.error().message;
    EXPECT_NE(pose.error().message.find("rigid_body_pose_cov_t"), std::string::npos);
  }
  auto bytes = encoded(pose_cov_message(5, 0.0, 0.01, 0.002));
  bytes.push_back(0);
  EXPECT_EQ(decode_pose(bytes).error().reason, "size");
}

}  // namespace
}  // namespace planemap::service
